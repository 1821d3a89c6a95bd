#include "bespoke/clearance/detail/part_faces.h"

#include <algorithm>
#include <set>
#include <utility>

namespace bespoke {
namespace {

// Faces that were parted may come to pass through their neighbours, and so on.
constexpr int max_pushes = 16;
// So many of them that leave no fewer end a pass.
constexpr int max_vain_pushes = 4;
constexpr int max_joins = 4;
constexpr int max_passes = 2;

/// The correction with the fewest pairs so far.
class Best {
 public:
  Best(FacePassages& passages, Correction& correction, CorrectionSamples& samples)
      : passages_(passages), correction_(correction), samples_(samples) {
    pairs_ = look();
    keep();
  }

  const FacePairs& pairs() const { return pairs_; }
  CorrectionSamples& samples() const { return samples_; }
  Correction& correction() const { return correction_; }

  /// Takes the correction as it is now, if it is better. The pairs as it is now.
  FacePairs take() {
    FacePairs now = look();
    if (now.size() < pairs_.size() && samples_.count().breaches <= breaches_) {
      pairs_ = now;
      keep();
    }
    return now;
  }

  /// Goes back to the best.
  void restore() {
    correction_.move_to(u_, samples_.distances());
    look_at_checks();
  }

 private:
  FacePairs look() {
    look_at_checks();
    return passages_.found();
  }
  void look_at_checks() {
    const Points vertices = correction_.vertices();
    samples_.look_at_checks(vertices);
    passages_.move_to(vertices);
  }
  void keep() {
    u_ = correction_.displacement();
    breaches_ = samples_.count().breaches;
  }

  FacePassages& passages_;
  Correction& correction_;
  CorrectionSamples& samples_;
  FacePairs pairs_;
  NodeVectors u_;
  std::size_t breaches_ = 0;
};

/// The nodes of faces of the product that pass through each other move alike.
void join(const FacePassages& passages, Best& best) {
  for (int attempt = 0; attempt < max_joins; ++attempt) {
    const std::size_t before = best.pairs().size();
    const FacePairs own = passages.of_product(best.pairs());
    if (own.empty()) return;
    best.correction().move_to(best.correction().joined(own), best.samples().distances());
    best.take();
    best.restore();
    if (best.pairs().size() == before) return;
  }
}

/// Pairs once found stay constraints: `held`.
void push(const FacePassages& passages, double margin, Best& best, std::set<std::pair<int, int>>& held) {
  FacePairs pairs = best.pairs();
  int vain = 0;
  for (int round = 0; round < max_pushes && vain < max_vain_pushes && !pairs.empty(); ++round) {
    const std::size_t fewest = best.pairs().size();
    held.insert(pairs.begin(), pairs.end());
    best.samples().constrain_what_misses();
    best.correction().push(passages.pushes({held.begin(), held.end()}, margin), best.samples().distances());
    pairs = best.take();
    vain = best.pairs().size() < fewest ? 0 : vain + 1;
  }
  best.restore();
}

}  // namespace

FacePairs part_faces(FacePassages& passages, double margin, Correction& correction,
                     CorrectionSamples& samples) {
  Best best(passages, correction, samples);
  std::set<std::pair<int, int>> held;
  for (int pass = 0; pass < max_passes && !best.pairs().empty(); ++pass) {
    const std::size_t before = best.pairs().size();
    join(passages, best);
    push(passages, margin, best, held);
    if (best.pairs().size() == before) break;
  }
  return best.pairs();
}

}  // namespace bespoke
