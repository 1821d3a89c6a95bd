#include "bespoke/elastic/exact_map_io.h"

#include "bespoke/elastic/detail/exact_map_bytes.h"
#include "bespoke/elastic/elastic_methods.h"
#include "bespoke/error.h"
#include "bespoke/mapping/elastic_chain.h"

namespace bespoke {
namespace {

constexpr std::string_view magic = "BSPKEXCT";
constexpr std::string_view chain_magic = "BSPKCHN1";
constexpr std::uint32_t version = 1;

std::string serialize_chain(const ElasticChain& chain) {
  if (chain.steps().size() == 1) return serialize_exact_map(*chain.steps().front());
  ExactMapWriter writer;
  writer.text(chain_magic);
  writer.integer(static_cast<std::uint64_t>(chain.steps().size()));
  std::string bytes = writer.take();
  for (const auto& step : chain.steps()) {
    const std::string part = serialize_exact_map(*step);
    ExactMapWriter length;
    length.integer(static_cast<std::uint64_t>(part.size()));
    bytes += length.take() + part;
  }
  return bytes;
}

std::shared_ptr<const ElasticMap> parse_chain(std::string_view bytes) {
  constexpr std::size_t word = sizeof(std::uint64_t);
  const auto take_count = [&] {
    if (bytes.size() < word) reject_exact_map("ends within a chain");
    ExactMapReader reader(bytes.substr(0, word));
    const auto count = reader.integer<std::uint64_t>();
    bytes.remove_prefix(word);
    return count;
  };
  std::vector<std::shared_ptr<const ElasticMap>> steps;
  const std::uint64_t count = take_count();
  for (std::uint64_t k = 0; k < count; ++k) {
    const std::uint64_t size = take_count();
    if (size > bytes.size() || bytes.substr(0, chain_magic.size()) == chain_magic)
      reject_exact_map("step " + std::to_string(k) + " of a chain is none");
    steps.push_back(parse_exact_map(bytes.substr(0, static_cast<std::size_t>(size))));
    bytes.remove_prefix(static_cast<std::size_t>(size));
  }
  if (!bytes.empty() || steps.size() < 2) reject_exact_map("a chain has other steps than it says");
  return std::make_shared<const ElasticChain>(std::move(steps));
}

}  // namespace

std::string serialize_exact_map(const ElasticMap& map) {
  if (const auto* chain = dynamic_cast<const ElasticChain*>(&map)) return serialize_chain(*chain);
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
  if (bytes.starts_with(chain_magic)) return parse_chain(bytes.substr(chain_magic.size()));
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
