#include "bespoke/rbf/front_cholesky.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <string>

#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

using Front = EliminationTree::Front;

/// update -= factor factorᵀ, lower triangle only, by blocks of columns.
void subtract_product(const Eigen::Ref<const Eigen::MatrixXd>& factor, Eigen::MatrixXd& update) {
  constexpr std::size_t columns = 96;
  parallel_for(std::size_t(update.cols()), columns, [&](std::size_t begin, std::size_t end) {
    const auto first = Eigen::Index(begin);
    const auto width = Eigen::Index(end - begin);
    const Eigen::Index rows = update.rows() - first;
    update.block(first, first, rows, width).noalias() -=
        factor.bottomRows(rows) * factor.middleRows(first, width).transpose();
  });
}

/// factor ← factor L⁻ᵀ, by blocks of rows.
void divide_by_transposed(const Eigen::Ref<const Eigen::MatrixXd>& lower,
                          Eigen::Ref<Eigen::MatrixXd> factor) {
  constexpr std::size_t rows = 192;
  parallel_for(std::size_t(factor.rows()), rows, [&](std::size_t begin, std::size_t end) {
    auto block = factor.middleRows(Eigen::Index(begin), Eigen::Index(end - begin));
    lower.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(block);
  });
}

}  // namespace

FrontCholesky::FrontCholesky(const EliminationTree& tree, const RadiusGraph& graph,
                             const std::vector<double>& values, const Progress& progress)
    : tree_(tree), graph_(graph), values_(values), progress_(progress), panels_(tree.fronts().size()) {
  if (!panels_.empty()) factor(int(panels_.size()) - 1);
}

Eigen::Index FrontCholesky::row(const Front& front, int point) const {
  // A plane may leave nothing between two halves: then a front has no points of its own.
  if (!front.own.empty()) {
    const int offset = tree_.position(point) - tree_.position(front.own.front());
    if (offset < int(front.own.size())) return offset;
  }
  const auto found = std::lower_bound(front.boundary.begin(), front.boundary.end(), point,
                                      [&](int a, int b) { return tree_.position(a) < tree_.position(b); });
  return Eigen::Index(front.own.size()) + (found - front.boundary.begin());
}

void FrontCholesky::add_entries(const Front& front, Eigen::MatrixXd& panel) const {
  for (std::size_t column = 0; column < front.own.size(); ++column) {
    const auto point = std::size_t(front.own[column]);
    for (std::size_t entry = graph_.start[point]; entry < graph_.start[point + 1]; ++entry)
      if (tree_.position(graph_.neighbours[entry]) >= tree_.position(front.own[column]))
        panel(row(front, graph_.neighbours[entry]), Eigen::Index(column)) = values_[entry];
  }
}

void FrontCholesky::add_child(int child, const Front& front, const Eigen::MatrixXd& child_update,
                              Eigen::MatrixXd& panel, Eigen::MatrixXd& update) const {
  const std::vector<int>& boundary = tree_.fronts()[std::size_t(child)].boundary;
  std::vector<Eigen::Index> rows(boundary.size());
  for (std::size_t i = 0; i < boundary.size(); ++i) rows[i] = row(front, boundary[i]);
  const auto own = Eigen::Index(front.own.size());
  for (std::size_t j = 0; j < rows.size(); ++j)
    for (std::size_t i = j; i < rows.size(); ++i) {
      const double value = child_update(Eigen::Index(i), Eigen::Index(j));
      if (rows[j] < own)
        panel(rows[i], rows[j]) += value;
      else
        update(rows[i] - own, rows[j] - own) += value;
    }
}

/// The multifrontal method (Duff, Reid 1983).
Eigen::MatrixXd FrontCholesky::factor(int index) {
  const Front& front = tree_.fronts()[std::size_t(index)];
  Eigen::MatrixXd child_updates[2];
  if (front.children[0] >= 0)
    parallel_for(
        2, 1, [&](std::size_t child, std::size_t) { child_updates[child] = factor(front.children[child]); });
  progress_.check();

  const auto own = Eigen::Index(front.own.size());
  const auto boundary = Eigen::Index(front.boundary.size());
  Eigen::MatrixXd& panel = panels_[std::size_t(index)];
  panel.setZero(own + boundary, own);
  Eigen::MatrixXd update = Eigen::MatrixXd::Zero(boundary, boundary);
  add_entries(front, panel);
  for (int child = 0; child < 2; ++child) {
    if (front.children[child] < 0) continue;
    add_child(front.children[child], front, child_updates[child], panel, update);
    child_updates[child].resize(0, 0);
  }
  if (own == 0) return update;

  Eigen::Ref<Eigen::MatrixXd> diagonal = panel.topRows(own);
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> cholesky(diagonal);
  if (cholesky.info() != Eigen::Success)
    throw SolverError("the radial system of " + std::to_string(graph_.start.size() - 1) +
                      " centres is not positive definite to working precision");
  if (boundary > 0) {
    divide_by_transposed(panel.topRows(own), panel.bottomRows(boundary));
    subtract_product(panel.bottomRows(boundary), update);
  }
  return update;
}

Eigen::MatrixXd FrontCholesky::solve(const Eigen::MatrixXd& right_side) const {
  Eigen::MatrixXd x(right_side.rows(), right_side.cols());
  for (int i = 0; i < right_side.rows(); ++i) x.row(tree_.position(i)) = right_side.row(i);
  const auto& fronts = tree_.fronts();
  const auto first_row = [&](const Front& front) { return Eigen::Index(tree_.position(front.own.front())); };
  for (std::size_t f = 0; f < fronts.size(); ++f) {
    if (fronts[f].own.empty()) continue;
    const auto own = Eigen::Index(fronts[f].own.size());
    auto mine = x.middleRows(first_row(fronts[f]), own);
    panels_[f].topRows(own).triangularView<Eigen::Lower>().solveInPlace(mine);
    const Eigen::MatrixXd change = panels_[f].bottomRows(panels_[f].rows() - own) * mine;
    for (std::size_t i = 0; i < fronts[f].boundary.size(); ++i)
      x.row(tree_.position(fronts[f].boundary[i])) -= change.row(Eigen::Index(i));
  }
  for (std::size_t f = fronts.size(); f-- > 0;) {
    if (fronts[f].own.empty()) continue;
    const auto own = Eigen::Index(fronts[f].own.size());
    Eigen::MatrixXd later(fronts[f].boundary.size(), x.cols());
    for (std::size_t i = 0; i < fronts[f].boundary.size(); ++i)
      later.row(Eigen::Index(i)) = x.row(tree_.position(fronts[f].boundary[i]));
    auto mine = x.middleRows(first_row(fronts[f]), own);
    mine -= panels_[f].bottomRows(panels_[f].rows() - own).transpose() * later;
    panels_[f].topRows(own).triangularView<Eigen::Lower>().transpose().solveInPlace(mine);
  }
  Eigen::MatrixXd result(x.rows(), x.cols());
  for (int i = 0; i < result.rows(); ++i) result.row(i) = x.row(tree_.position(i));
  return result;
}

}  // namespace bespoke
