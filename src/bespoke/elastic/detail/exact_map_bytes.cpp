#include "bespoke/elastic/detail/exact_map_bytes.h"

#include "bespoke/error.h"

namespace bespoke {

void reject_exact_map(const std::string& reason) {
  throw FormatError("exact map: " + reason + "; the asset was damaged or written by another version");
}

}  // namespace bespoke
