#include "bespoke/fitting/exact_map_io.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/fitting/pffd.h"
#include "bespoke/rbf/csrbf.h"
#include "bespoke/rbf/multiscale.h"

namespace bespoke {
namespace {

static_assert(std::endian::native == std::endian::little, "the bytes of an exact map are little endian");

constexpr std::uint64_t magic = 0x3150414d54435845;  // "EXCTMAP1"

enum class Kind : std::uint64_t { csrbf = 1, multiscale = 2, pffd = 3 };

class Writer {
 public:
  explicit Writer(Kind kind) {
    put(magic);
    put(static_cast<std::uint64_t>(kind));
  }
  void put(std::uint64_t value) { append(&value, sizeof value); }
  void put(double value) { append(&value, sizeof value); }
  template <class Matrix>
  void put_columns(const Matrix& matrix) {
    put(static_cast<std::uint64_t>(matrix.cols()));
    append(matrix.data(), sizeof(typename Matrix::Scalar) * static_cast<std::size_t>(matrix.size()));
  }
  void put(const AffineMap& affine) {
    append(affine.linear.data(), sizeof(double) * 9);
    append(affine.offset.data(), sizeof(double) * 3);
  }
  std::string take() { return std::move(bytes_); }

 private:
  void append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {
    require(unsigned_integer() == magic, "does not begin as one");
  }
  std::uint64_t unsigned_integer() {
    std::uint64_t value = 0;
    copy(&value, sizeof value);
    return value;
  }
  double positive_length() {
    double value = 0;
    copy(&value, sizeof value);
    require(value > 0 && std::isfinite(value), "has a length that is not positive");
    return value;
  }
  template <class Matrix>
  Matrix columns() {
    const std::uint64_t count = unsigned_integer();
    constexpr std::size_t column_bytes = 3 * sizeof(typename Matrix::Scalar);
    require(count <= (bytes_.size() - position_) / column_bytes, "ends early");
    Matrix matrix(3, static_cast<Eigen::Index>(count));
    copy(matrix.data(), count * column_bytes);
    return matrix;
  }
  Points points() {
    Points found = columns<Points>();
    require(found.allFinite(), "has a value that is not finite");
    return found;
  }
  AffineMap affine() {
    AffineMap found;
    copy(found.linear.data(), sizeof(double) * 9);
    copy(found.offset.data(), sizeof(double) * 3);
    require(found.linear.allFinite() && found.offset.allFinite(), "has a value that is not finite");
    return found;
  }
  void require_end() const { require(position_ == bytes_.size(), "has bytes after its end"); }
  static void require(bool holds, const char* trouble) {
    if (!holds) throw FormatError(std::string("the stored exact map ") + trouble);
  }

 private:
  void copy(void* to, std::size_t size) {
    require(size <= bytes_.size() - position_, "ends early");
    if (size > 0) std::memcpy(to, bytes_.data() + position_, size);
    position_ += size;
  }

  const std::string& bytes_;
  std::size_t position_ = 0;
};

std::string write_multiscale(const MultiscaleMap& map) {
  Writer writer(Kind::multiscale);
  writer.put(map.affine());
  writer.put(std::uint64_t{map.composed()});
  writer.put(std::uint64_t{map.layers().size()});
  for (const RbfLayer& layer : map.layers()) {
    writer.put(layer.lambda);
    writer.put_columns(layer.centers);
    writer.put_columns(layer.coefficients);
  }
  return writer.take();
}

std::shared_ptr<const ElasticMap> read_csrbf(Reader& reader) {
  const AffineMap affine = reader.affine();
  const double lambda = reader.positive_length();
  Points centers = reader.points();
  Points coefficients = reader.points();
  Reader::require(centers.cols() == coefficients.cols(), "has centres without coefficients");
  reader.require_end();
  return std::make_shared<CsrbfMap>(std::move(centers), std::move(coefficients), affine, lambda);
}

std::shared_ptr<const ElasticMap> read_multiscale(Reader& reader) {
  const AffineMap affine = reader.affine();
  const bool composed = reader.unsigned_integer() != 0;
  const std::uint64_t count = reader.unsigned_integer();
  std::vector<RbfLayer> layers;
  for (std::uint64_t k = 0; k < count; ++k) {
    RbfLayer layer;
    layer.lambda = reader.positive_length();
    layer.centers = reader.points();
    layer.coefficients = reader.points();
    Reader::require(layer.centers.cols() == layer.coefficients.cols(), "has centres without coefficients");
    layers.push_back(std::move(layer));
  }
  reader.require_end();
  return std::make_shared<MultiscaleMap>(affine, std::move(layers), composed);
}

std::shared_ptr<const ElasticMap> read_pffd(Reader& reader) {
  const double lambda = reader.positive_length();
  TriangleMesh source;
  source.vertices = reader.points();
  source.faces = reader.columns<Faces>();
  const Points fitted = reader.points();
  reader.require_end();
  const auto vertices = static_cast<int>(source.vertices.cols());
  Reader::require(fitted.cols() == vertices, "has vertices without fitted positions");
  Reader::require(
      source.faces.size() > 0 && source.faces.minCoeff() >= 0 && source.faces.maxCoeff() < vertices,
      "has a face without vertices");
  return std::make_shared<PffdMap>(source, fitted, lambda);
}

}  // namespace

std::string write_exact_map(const ElasticMap& map, const TriangleMesh& source, const Points& fitted_vertices,
                            double lambda) {
  if (const auto* layers = dynamic_cast<const MultiscaleMap*>(&map)) return write_multiscale(*layers);
  if (const auto* csrbf = dynamic_cast<const CsrbfMap*>(&map)) {
    Writer writer(Kind::csrbf);
    writer.put(csrbf->affine());
    writer.put(csrbf->lambda());
    writer.put_columns(csrbf->centers());
    writer.put_columns(csrbf->coefficients());
    return writer.take();
  }
  if (dynamic_cast<const PffdMap*>(&map)) {
    Writer writer(Kind::pffd);
    writer.put(lambda);
    writer.put_columns(source.vertices);
    writer.put_columns(source.faces);
    writer.put_columns(fitted_vertices);
    return writer.take();
  }
  throw InvalidInput("only csrbf, multiscale, diffeomorphic and pffd maps can be stored exactly");
}

std::shared_ptr<const ElasticMap> read_exact_map(const std::string& bytes) {
  Reader reader(bytes);
  switch (static_cast<Kind>(reader.unsigned_integer())) {
    case Kind::csrbf:
      return read_csrbf(reader);
    case Kind::multiscale:
      return read_multiscale(reader);
    case Kind::pffd:
      return read_pffd(reader);
  }
  throw FormatError("the stored exact map is of an unknown kind");
}

}  // namespace bespoke
