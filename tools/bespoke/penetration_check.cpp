#include "penetration_check.h"

#include "bespoke/cloud/target_model.h"
#include "bespoke/error.h"
#include "bespoke/product/product_io.h"
#include "bespoke/quality/product_quality.h"
#include "planned_run.h"

namespace bespoke::command {
namespace {

void require_same(const std::string& path, const std::string& hash, const std::string& expected) {
  if (hash != expected)
    throw InvalidInput(path + ": is not the model that the map was made of (other vertices or faces)");
}

}  // namespace

struct PenetrationCheck::Models {
  Models(const std::string& source_file, const std::string& target_file, const OpenedMap& map)
      : source(read_source(source_file, map.unit, map.source_hash)),
        target(read_target(target_file, map.unit, map.target_hash)),
        from_source(source),
        from_target(target.mesh) {
    require_same(source_file, content_hash(source), map.source_hash);
    require_same(target_file, content_hash(target), map.target_hash);
  }

  TriangleMesh source;
  TargetModel target;
  SignedDistance from_source, from_target;
};

PenetrationCheck::PenetrationCheck(const std::string& source, const std::string& target)
    : source_(source), target_(target) {}
PenetrationCheck::~PenetrationCheck() = default;

std::string PenetrationCheck::operator()(const std::string& product, const OpenedMap& map,
                                         const std::string& unit, ModelPose pose) {
  if (source_.empty() || target_.empty()) return {};
  if (!models_) models_ = std::make_unique<const Models>(source_, target_, map);
  if (!can_read_product(product)) return {};
  const NamedProduct before = read_product_in(product, map.unit, unit, pose);
  const Points after = map.target_from_source * (*map.elastic)(before.mesh.vertices);
  const NewPenetration new_penetration = product_new_penetration(
      {before.mesh, before.line_edges}, after,
      {models_->source, models_->target.mesh, models_->from_source, models_->from_target});
  return new_penetration.is_notable() ? to_string(new_penetration) : std::string();
}

void warn_of_penetration(const RunContext& context, const MapModels& models,
                         const std::vector<Points>& corrected) {
  if (models.products.empty()) return;
  const ElasticChain elastic = baked_chain(models.asset.steps);
  const SignedDistance from_source(models.source), from_target(models.target);
  for (std::size_t i = 0; i < models.products.size(); ++i) {
    context.progress.check();
    const NamedProduct& product = models.products[i];
    const Points after = corrected.empty()
                             ? Points(models.asset.target_from_source * elastic(product.mesh.vertices))
                             : corrected[i];
    const NewPenetration new_penetration = product_new_penetration(
        {product.mesh, product.line_edges}, after, {models.source, models.target, from_source, from_target});
    if (new_penetration.is_notable())
      context.warn(product.name + ": " + to_string(new_penetration), Entry::product_inside_the_target);
  }
}

}  // namespace bespoke::command
