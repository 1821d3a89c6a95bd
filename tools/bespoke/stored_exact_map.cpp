#include "stored_exact_map.h"

#include "bespoke/elastic/exact_map_io.h"
#include "bespoke/error.h"

namespace bespoke::command {

std::shared_ptr<const ElasticMap> stored_exact_map(const std::string& path, const Asset& asset) {
  if (asset.exact_map.empty())
    throw InvalidInput(path + ": holds no exact map; make it with `bespoke fit --keep-exact`");
  try {
    return parse_exact_map(asset.exact_map);
  } catch (const FormatError& error) {
    throw FormatError(path + ": " + error.what());
  }
}

}  // namespace bespoke::command
