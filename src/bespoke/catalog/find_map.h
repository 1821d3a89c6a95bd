#pragma once

#include <string>

#include "bespoke/catalog/catalog.h"

namespace bespoke {

/// The models that a map leads from and to, by the first digits of their content_hash.
struct ModelHashes {
  std::string source;
  std::string target;  ///< empty: any
};

/// The one map of the models. Throws InvalidInput when there is none, or more than one, naming those that
/// there are; and for hashes of less than six digits.
const CatalogEntry& find_map(const Catalog& catalog, const ModelHashes& models);

}  // namespace bespoke
