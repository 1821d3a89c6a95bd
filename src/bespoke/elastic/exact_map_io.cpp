#include "bespoke/elastic/exact_map_io.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "bespoke/elastic/csrbf.h"
#include "bespoke/elastic/multiscale.h"
#include "bespoke/elastic/pffd.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr std::string_view magic = "BSPKEXCT";
constexpr std::uint32_t version = 1;

enum class Type : std::uint32_t { csrbf = 1, multiscale = 2, pffd = 3 };

class Writer {
 public:
  template <class Unsigned>
  void integer(Unsigned value) {
    static_assert(std::is_unsigned_v<Unsigned>);
    for (std::size_t byte = 0; byte < sizeof value; ++byte)
      bytes_ += static_cast<char>(value >> (8 * byte) & 0xFF);
  }
  void number(double value) { integer(std::bit_cast<std::uint64_t>(value)); }
  void count(Eigen::Index value) { integer(static_cast<std::uint64_t>(value)); }

  template <class Matrix>
  void numbers(const Matrix& values) {
    for (Eigen::Index column = 0; column < values.cols(); ++column)
      for (Eigen::Index row = 0; row < values.rows(); ++row) number(values(row, column));
  }
  void points(const Points& values) {
    count(values.cols());
    numbers(values);
  }
  void affine(const AffineMap& map) {
    numbers(map.linear);
    numbers(map.offset);
  }
  void text(std::string_view value) { bytes_ += value; }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

[[noreturn]] void reject(const std::string& reason) {
  throw FormatError("exact map: " + reason + "; the asset was damaged or written by another version");
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  std::string_view text(std::size_t size) {
    if (bytes_.size() < size) reject("ends " + std::to_string(size - bytes_.size()) + " bytes too early");
    const std::string_view result = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return result;
  }
  template <class Unsigned>
  Unsigned integer() {
    Unsigned value = 0;
    const std::string_view read = text(sizeof value);
    for (std::size_t byte = 0; byte < sizeof value; ++byte)
      value |= static_cast<Unsigned>(static_cast<unsigned char>(read[byte])) << (8 * byte);
    return value;
  }
  double number(const char* what) {
    const auto value = std::bit_cast<double>(integer<std::uint64_t>());
    if (!std::isfinite(value)) reject(std::string(what) + " is not finite");
    return value;
  }
  double positive(const char* what) {
    const double value = number(what);
    if (!(value > 0)) reject(std::string(what) + " is not above 0");
    return value;
  }
  /// How many items of at least `bytes_each` follow; never more than there are bytes for.
  Eigen::Index count(std::size_t bytes_each, const char* what) {
    const auto value = integer<std::uint64_t>();
    if (value > bytes_.size() / bytes_each)
      reject(std::to_string(value) + " " + what + " do not fit into the " + std::to_string(bytes_.size()) +
             " bytes that follow");
    return static_cast<Eigen::Index>(value);
  }
  template <class Matrix>
  void numbers(Matrix& values, const char* what) {
    for (Eigen::Index column = 0; column < values.cols(); ++column)
      for (Eigen::Index row = 0; row < values.rows(); ++row) values(row, column) = number(what);
  }
  Points points(const char* what) {
    Points values(3, count(3 * sizeof(double), what));
    numbers(values, what);
    return values;
  }
  AffineMap affine() {
    AffineMap map;
    numbers(map.linear, "the affine part");
    numbers(map.offset, "the affine part");
    return map;
  }
  void end() const {
    if (!bytes_.empty()) reject(std::to_string(bytes_.size()) + " bytes too many");
  }

 private:
  std::string_view bytes_;
};

std::shared_ptr<const ElasticMap> parse_csrbf(Reader& reader) {
  const AffineMap affine = reader.affine();
  const double lambda = reader.positive("lambda");
  Points centers = reader.points("centres");
  Points coefficients = reader.points("coefficients");
  reader.end();
  if (centers.cols() != coefficients.cols()) reject("as many coefficients as centres are needed");
  return std::make_shared<CsrbfMap>(std::move(centers), std::move(coefficients), affine, lambda);
}

std::shared_ptr<const ElasticMap> parse_multiscale(Reader& reader) {
  const AffineMap affine = reader.affine();
  const auto composed = reader.integer<std::uint32_t>();
  if (composed > 1) reject("neither composed nor summed");
  constexpr std::size_t smallest_layer = sizeof(double) + 2 * sizeof(std::uint64_t);
  std::vector<RbfLayer> layers(static_cast<std::size_t>(reader.count(smallest_layer, "layers")));
  for (RbfLayer& layer : layers) {
    layer.lambda = reader.positive("lambda");
    layer.centers = reader.points("centres");
    layer.coefficients = reader.points("coefficients");
    if (layer.centers.cols() != layer.coefficients.cols())
      reject("as many coefficients as centres are needed");
  }
  reader.end();
  return std::make_shared<MultiscaleMap>(affine, std::move(layers), composed == 1);
}

std::shared_ptr<const ElasticMap> parse_pffd(Reader& reader) {
  const double lambda = reader.positive("lambda");
  TriangleMesh source;
  source.vertices = reader.points("source vertices");
  const Points fitted = reader.points("fitted vertices");
  source.faces.resize(3, reader.count(3 * sizeof(std::uint32_t), "faces"));
  for (Eigen::Index i = 0; i < source.faces.size(); ++i) {
    const auto vertex = reader.integer<std::uint32_t>();
    if (!(vertex < source.vertices.cols())) reject("a face uses vertex " + std::to_string(vertex));
    source.faces(i) = static_cast<int>(vertex);
  }
  reader.end();
  return std::make_shared<PffdMap>(source, fitted, lambda);
}

}  // namespace

std::string serialize_exact_map(const ElasticMap& map) {
  Writer writer;
  writer.text(magic);
  writer.integer(version);
  const auto type = [&](Type value) { writer.integer(static_cast<std::uint32_t>(value)); };
  if (const auto* csrbf = dynamic_cast<const CsrbfMap*>(&map)) {
    type(Type::csrbf);
    writer.affine(csrbf->affine());
    writer.number(csrbf->lambda());
    writer.points(csrbf->centers());
    writer.points(csrbf->coefficients());
  } else if (const auto* multiscale = dynamic_cast<const MultiscaleMap*>(&map)) {
    type(Type::multiscale);
    writer.affine(multiscale->affine());
    writer.integer(std::uint32_t{multiscale->composed()});
    writer.count(static_cast<Eigen::Index>(multiscale->layers().size()));
    for (const RbfLayer& layer : multiscale->layers()) {
      writer.number(layer.lambda);
      writer.points(layer.centers);
      writer.points(layer.coefficients);
    }
  } else if (const auto* pffd = dynamic_cast<const PffdMap*>(&map)) {
    type(Type::pffd);
    writer.number(pffd->lambda());
    writer.points(pffd->source().vertices);
    writer.points(pffd->fitted());
    writer.count(pffd->source().faces.cols());
    for (Eigen::Index i = 0; i < pffd->source().faces.size(); ++i)
      writer.integer(static_cast<std::uint32_t>(pffd->source().faces(i)));
  } else {
    throw InvalidInput("an elastic map of this type is not exact: it cannot be kept for apply --exact");
  }
  return writer.take();
}

std::shared_ptr<const ElasticMap> parse_exact_map(std::string_view bytes) {
  Reader reader(bytes);
  if (reader.text(magic.size()) != magic) reject("does not begin as one");
  if (const auto found = reader.integer<std::uint32_t>(); found != version)
    reject("version " + std::to_string(found) + ", only " + std::to_string(version) + " is known");
  const auto type = reader.integer<std::uint32_t>();
  try {
    switch (static_cast<Type>(type)) {
      case Type::csrbf:
        return parse_csrbf(reader);
      case Type::multiscale:
        return parse_multiscale(reader);
      case Type::pffd:
        return parse_pffd(reader);
    }
  } catch (const InvalidInput& error) {
    reject(error.what());
  }
  reject("unknown type " + std::to_string(type));
}

}  // namespace bespoke
