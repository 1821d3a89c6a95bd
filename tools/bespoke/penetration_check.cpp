#include "penetration_check.h"

#include <tuple>

#include "bespoke/cloud/target_model.h"
#include "bespoke/error.h"
#include "bespoke/product/product_io.h"
#include "bespoke/quality/product_quality.h"

namespace bespoke::command {

struct PenetrationCheck::Models {
  Models(const std::string& source_file, const std::string& target_file)
      : source_path(source_file),
        target_path(target_file),
        source(read_source(source_file)),
        target(read_target(target_file)),
        from_source(source),
        from_target(target.mesh) {}

  void require_of(const OpenedMap& map) const {
    for (const auto& [path, hash, expected] :
         {std::tuple(source_path, content_hash(source), map.source_hash),
          std::tuple(target_path, content_hash(target), map.target_hash)})
      if (hash != expected)
        throw InvalidInput(path + ": is not the model that the map was made of (other vertices or faces)");
  }

  std::string source_path, target_path;
  TriangleMesh source;
  TargetModel target;
  SignedDistance from_source, from_target;
};

PenetrationCheck::PenetrationCheck(const std::string& source, const std::string& target) {
  if (!source.empty() && !target.empty()) models_ = std::make_unique<const Models>(source, target);
}
PenetrationCheck::~PenetrationCheck() = default;

std::string PenetrationCheck::operator()(const std::string& product, const OpenedMap& map) const {
  if (!models_ || !can_read_product(product)) return {};
  models_->require_of(map);
  const Product read = read_product(product);
  const TriangleMesh before{read.vertices, triangulated(read)};
  const Points after = map.target_from_source * (*map.elastic)(before.vertices);
  const NewPenetration new_penetration = product_new_penetration(
      before, after, {models_->source, models_->target.mesh, models_->from_source, models_->from_target});
  return new_penetration.is_notable() ? to_string(new_penetration) : std::string();
}

}  // namespace bespoke::command
