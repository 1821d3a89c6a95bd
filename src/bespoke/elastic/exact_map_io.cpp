#include "bespoke/elastic/exact_map_io.h"

#include "bespoke/elastic/detail/exact_map_bytes.h"
#include "bespoke/elastic/elastic_methods.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr std::string_view magic = "BSPKEXCT";
constexpr std::uint32_t version = 1;

}  // namespace

void reject_exact_map(const std::string& reason) {
  throw FormatError("exact map: " + reason + "; the asset was damaged or written by another version");
}

std::string serialize_exact_map(const ElasticMap& map) {
  for (const ElasticMethodRow& row : elastic_methods) {
    if (!row.stored.holds(map)) continue;
    ExactMapWriter writer;
    writer.text(magic);
    writer.integer(version);
    writer.integer(row.stored.number);
    row.stored.write(map, writer);
    return writer.take();
  }
  throw InvalidInput("an elastic map of this type is not exact: it cannot be kept for apply --exact");
}

std::shared_ptr<const ElasticMap> parse_exact_map(std::string_view bytes) {
  ExactMapReader reader(bytes);
  if (reader.text(magic.size()) != magic) reject_exact_map("does not begin as one");
  if (const auto found = reader.integer<std::uint32_t>(); found != version)
    reject_exact_map("version " + std::to_string(found) + ", only " + std::to_string(version) + " is known");
  const auto type = reader.integer<std::uint32_t>();
  for (const ElasticMethodRow& row : elastic_methods) {
    if (row.stored.number != type) continue;
    try {
      return row.stored.read(reader);
    } catch (const InvalidInput& error) {
      reject_exact_map(error.what());
    }
  }
  reject_exact_map("unknown type " + std::to_string(type));
}

}  // namespace bespoke
