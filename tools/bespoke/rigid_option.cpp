#include "rigid_option.h"

#include <set>

#include "bespoke/error.h"
#include "bespoke/product/carry_product.h"

namespace bespoke::command {

void add_part_options(CLI::App& app, PartNames& names) {
  app.add_option(
         "--rigid", names.rigid,
         "A part that keeps its shape: it gets the rigid motion that fits its mapped points best. An OBJ "
         "group, object or material, a glTF node, or a PLY component by its number; repeatable")
      ->type_name("NAME")
      ->allow_extra_args(false);
  app.add_option("--similar", names.similar,
                 "A part that may also be scaled as a whole (a similarity); repeatable")
      ->type_name("NAME")
      ->allow_extra_args(false);
}

PartsOfProducts parts_of_products(const std::vector<std::string>& products, const PartNames& names,
                                  ModelPose pose) {
  std::vector<RigidPart> named;
  for (const std::string& name : names.rigid) named.push_back({name, PartMotion::rigid});
  for (const std::string& name : names.similar) named.push_back({name, PartMotion::similar});
  PartsOfProducts parts;
  if (named.empty()) return parts;
  if (products.size() == 1) return {{products.front(), named}};
  std::set<std::string> known;
  for (const std::string& product : products) {
    parts[product] = parts_present(product, named, pose);
    for (const RigidPart& part : parts[product]) known.insert(part.name);
  }
  for (const RigidPart& part : named)
    if (!known.contains(part.name)) throw InvalidInput("none of the products has a part '" + part.name + "'");
  return parts;
}

}  // namespace bespoke::command
