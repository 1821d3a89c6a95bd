#include "bespoke/clearance/detail/face_passages.h"

#include <algorithm>

#include "bespoke/clearance/detail/face_parting.h"
#include "bespoke/quality/self_intersection.h"

namespace bespoke {
namespace {

constexpr std::size_t max_passages = 10;

}  // namespace

FacePassages::FacePassages(const TriangleMesh& product, const Points& carried,
                           const std::vector<Obstacle>& obstacles)
    : product_faces_(static_cast<int>(product.faces.cols())), product_vertices_(product.vertices.cols()) {
  Eigen::Index vertices = product_vertices_, faces = product.faces.cols();
  for (const Obstacle& obstacle : obstacles)
    if (obstacle.layer) {
      vertices += obstacle.layer->before.vertices.cols();
      faces += obstacle.layer->before.faces.cols();
    }
  now_ = {Points(3, vertices), Faces(3, faces)};
  on_source_.resize(3, vertices);
  now_.vertices.leftCols(product_vertices_) = carried;
  now_.faces.leftCols(product_faces_) = product.faces;
  on_source_.leftCols(product_vertices_) = product.vertices;
  Eigen::Index vertex = product_vertices_, face = product_faces_;
  ends_.emplace_back(product_faces_, "itself");
  for (const Obstacle& obstacle : obstacles) {
    if (!obstacle.layer) continue;
    const TriangleMesh& layer = obstacle.layer->before;
    now_.vertices.middleCols(vertex, layer.vertices.cols()) = obstacle.layer->after;
    on_source_.middleCols(vertex, layer.vertices.cols()) = layer.vertices;
    now_.faces.middleCols(face, layer.faces.cols()) = layer.faces.array() + static_cast<int>(vertex);
    vertex += layer.vertices.cols();
    face += layer.faces.cols();
    ends_.emplace_back(static_cast<int>(face), obstacle.name);
  }
  carried_ = now_.vertices;
}

FacePairs FacePassages::found() {
  if (product_faces_ == 0) return {};
  if (has_layers() && !through_layers_) {
    through_layers_ = intersections_of_first({on_source_, now_.faces}, product_faces_);
    std::erase_if(*through_layers_, [&](const auto& pair) { return is_of_product(pair.second); });
  }
  std::vector<char> is_looked_at(static_cast<std::size_t>(now_.faces.cols()), 0);
  for (Eigen::Index face = 0; face < product_faces_; ++face)
    for (const int vertex : now_.faces.col(face))
      if (has_layers() || now_.vertices.col(vertex) != carried_.col(vertex))
        is_looked_at[static_cast<std::size_t>(face)] = 1;
  FacePairs further = intersections_of(now_, is_looked_at);
  FacePairs before = intersecting({carried_, now_.faces}, of_product(further));
  if (through_layers_) before.insert(before.end(), through_layers_->begin(), through_layers_->end());
  std::sort(before.begin(), before.end());
  std::erase_if(further,
                [&](const auto& pair) { return std::binary_search(before.begin(), before.end(), pair); });
  return further;
}

FacePairs FacePassages::of_product(const FacePairs& pairs) const {
  FacePairs own;
  for (const auto& pair : pairs)
    if (is_of_product(pair.second)) own.push_back(pair);
  return own;
}

std::vector<LayerPairs> FacePassages::of_layers(const FacePairs& pairs) const {
  std::vector<LayerPairs> counts(ends_.size() - 1);
  const auto layer_of = [&](int face) -> LayerPairs& {
    const auto end =
        std::find_if(ends_.begin(), ends_.end(), [&](const auto& one) { return face < one.first; });
    return counts[static_cast<std::size_t>(end - ends_.begin()) - 1];
  };
  if (through_layers_)
    for (const auto& pair : *through_layers_) ++layer_of(pair.second).before;
  for (const auto& pair : pairs)
    if (!is_of_product(pair.second)) ++layer_of(pair.second).after;
  return counts;
}

std::vector<PassedThrough> FacePassages::places(const FacePairs& pairs, double radius) const {
  std::vector<PassedThrough> found;
  for (const auto& [face, other] : pairs) {
    const Vector3 place = corners(face, now_.vertices).rowwise().mean();
    const auto near = std::find_if(found.begin(), found.end(), [&, other = other](const PassedThrough& one) {
      return one.other == name_of(other) && (one.place - place).norm() < radius;
    });
    if (near != found.end())
      ++near->pairs;
    else
      found.push_back({name_of(other), place, 1});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.pairs > b.pairs; });
  if (found.size() > max_passages) found.resize(max_passages);
  return found;
}

void FacePassages::add_vertices(const std::pair<int, int>& pair, std::vector<int>& vertices) const {
  for (const int face : {pair.first, pair.second})
    if (is_of_product(face))
      for (const int vertex : now_.faces.col(face)) vertices.push_back(vertex);
}

const std::string& FacePassages::name_of(int face) const {
  return std::find_if(ends_.begin(), ends_.end(), [&](const auto& end) { return face < end.first; })->second;
}

std::vector<Push> FacePassages::pushes(const FacePairs& pairs, double margin) const {
  std::vector<Push> all;
  for (const auto& pair : pairs) add_pushes(pair, margin, all);
  return all;
}

Matrix3 FacePassages::corners(int face, const Points& vertices) const {
  Matrix3 found;
  for (int k = 0; k < 3; ++k) found.col(k) = vertices.col(now_.faces(k, face));
  return found;
}

/// Each corner of the product's face against the corner of the other that reaches farthest.
void FacePassages::add_pushes(const std::pair<int, int>& pair, double margin,
                              std::vector<Push>& pushes) const {
  const bool is_own = is_of_product(pair.second);
  const Points& before = is_own ? carried_ : on_source_;
  const int first = pair.second, second = pair.first;
  const Matrix3 first_now = corners(first, now_.vertices), second_now = corners(second, now_.vertices);
  const auto apart = parting(corners(first, before), corners(second, before), first_now, second_now);
  if (!apart) return;
  Eigen::Index farthest = 0;
  const double end = (apart->axis.transpose() * first_now).maxCoeff(&farthest);
  for (int k = 0; k < 3; ++k) {
    Push push{{{now_.faces(k, second), 1}},
              apart->axis,
              end + margin - apart->axis.dot(second_now.col(k)),
              {first, second, k}};
    if (is_own) push.vertices.emplace_back(now_.faces(farthest, first), -1);
    pushes.push_back(std::move(push));
  }
}

}  // namespace bespoke
