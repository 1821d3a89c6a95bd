#include "bespoke/mapping/scaled_map.h"

#include <utility>
#include <vector>

#include "bespoke/mapping/elastic_chain.h"
#include "bespoke/mapping/reach.h"

namespace bespoke {
namespace {

class ScaledMap : public ElasticMap, public HasOwnReach {
 public:
  ScaledMap(std::shared_ptr<const ElasticMap> map, double scale) : map_(std::move(map)), scale_(scale) {}

  AffineMap affine() const override {
    const AffineMap own = map_->affine();
    return {own.linear, own.offset / scale_};
  }
  Points displacement(const Points& x) const override { return map_->displacement(scale_ * x) / scale_; }
  Points displacement_gradient(const Points& x) const override {
    return map_->displacement_gradient(scale_ * x);
  }
  std::size_t count_in_reach(const Points& x) const override {
    const Points scaled = scale_ * x;
    return bespoke::count_in_reach(*map_, scaled, map_->displacement(scaled));
  }
  Support support() const override {
    Support support = map_->support();
    support.frame.linear *= scale_;
    return support;
  }

 private:
  std::shared_ptr<const ElasticMap> map_;
  double scale_;
};

}  // namespace

std::shared_ptr<const ElasticMap> in_other_unit(std::shared_ptr<const ElasticMap> map, double scale) {
  if (scale == 1) return map;
  const auto* const chain = dynamic_cast<const ElasticChain*>(map.get());
  if (!chain) return std::make_shared<ScaledMap>(std::move(map), scale);
  std::vector<std::shared_ptr<const ElasticMap>> steps;
  for (const std::shared_ptr<const ElasticMap>& step : chain->steps())
    steps.push_back(std::make_shared<ScaledMap>(step, scale));
  return std::make_shared<ElasticChain>(std::move(steps));
}

RigidTransform in_other_unit(const RigidTransform& transform, double scale) {
  return {transform.rotation, transform.translation / scale};
}

}  // namespace bespoke
