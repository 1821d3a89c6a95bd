#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <ostream>

#include "bespoke/error.h"
#include "bespoke/exchange/detail/image_files.h"

namespace bespoke {
namespace {

constexpr std::size_t header_bytes = 348;
constexpr std::size_t extension_bytes = 4;  // all zero: there is none
constexpr std::int16_t float32 = 16;
constexpr std::int16_t displacement_vectors = 1006;
constexpr std::int16_t scanner_coordinates = 1;
constexpr int gzip_window = 15 + 16;  // zlib's largest, and 16 for a gzip header, which then holds no time
constexpr std::size_t floats_per_call = std::size_t{1} << 18;

/// Fields of nifti1.h by their offsets.
class Header {
 public:
  template <class Number>
  void set(std::size_t offset, std::initializer_list<Number> values) {
    std::memcpy(bytes_.data() + offset, std::data(values), values.size() * sizeof(Number));
  }
  void set(std::size_t offset, std::string_view text, std::size_t room) {
    text.substr(0, room - 1).copy(bytes_.data() + offset, room - 1);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_ = std::string(header_bytes + extension_bytes, '\0');
};

std::int16_t node_count(std::size_t nodes) {
  if (nodes > std::numeric_limits<std::int16_t>::max())
    throw InvalidInput(std::to_string(nodes) +
                       " nodes along an axis: NIfTI holds 32767; a larger --grid, or another format");
  return static_cast<std::int16_t>(nodes);
}

/// `turned` is -1 on the axes that point the other way in RAS.
Header header_of(const DisplacementImage& image, const ImageNotes& notes, const Eigen::Vector3f& turned) {
  Header header;
  header.set<std::int32_t>(0, {header_bytes});
  header.set<std::int16_t>(
      40, {5, node_count(image.size[0]), node_count(image.size[1]), node_count(image.size[2]), 1, 3, 1, 1});
  header.set<std::int16_t>(68, {displacement_vectors, float32, 32});
  const auto h = static_cast<float>(image.spacing);
  header.set<float>(76, {1, h, h, h, 1, 1, 1, 1});
  header.set<float>(108, {float{header_bytes + extension_bytes}, 1, 0});
  header.set(148, notes.content, 80);
  header.set<std::int16_t>(252, {scanner_coordinates, scanner_coordinates});
  // The quaternion's b, c, d: half a turn about z, or none.
  const Eigen::Vector3f origin = turned.cwiseProduct(image.origin.cast<float>());
  header.set<float>(256, {0, 0, turned.x() < 0 ? 1.0f : 0.0f, origin.x(), origin.y(), origin.z()});
  header.set<float>(280, {turned.x() * h, 0, 0, origin.x(), 0, turned.y() * h, 0, origin.y(), 0, 0,
                          turned.z() * h, origin.z()});
  header.set(344, "n+1", 4);
  return header;
}

class GzipWriter {
 public:
  explicit GzipWriter(std::ostream& out) : out_(out) {
    if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, gzip_window, /*memLevel=*/8,
                     Z_DEFAULT_STRATEGY) != Z_OK)
      throw MemoryLimitError("no memory to deflate an image");
  }
  ~GzipWriter() { deflateEnd(&stream_); }
  GzipWriter(const GzipWriter&) = delete;
  GzipWriter& operator=(const GzipWriter&) = delete;

  void write(const void* data, std::size_t bytes) { deflate_all(data, bytes, Z_NO_FLUSH); }
  void finish() { deflate_all(nullptr, 0, Z_FINISH); }

 private:
  void deflate_all(const void* data, std::size_t bytes, int flush) {
    stream_.next_in = static_cast<Bytef*>(const_cast<void*>(data));  // zlib only reads it
    stream_.avail_in = static_cast<uInt>(bytes);
    do {
      stream_.next_out = buffer_.data();
      stream_.avail_out = static_cast<uInt>(buffer_.size());
      deflate(&stream_, flush);
      out_.write(reinterpret_cast<const char*>(buffer_.data()),
                 static_cast<std::streamsize>(buffer_.size() - stream_.avail_out));
    } while (stream_.avail_out == 0);
  }

  std::ostream& out_;
  z_stream stream_{};
  std::array<Bytef, 1 << 16> buffer_;
};

}  // namespace

// Components one after the other, each over the whole grid.
void write_nifti_gz(std::ostream& out, const DisplacementImage& image, const ImageNotes& notes) {
  const float sign = notes.space == WorldSpace::lps ? -1.0f : 1.0f;
  const Eigen::Vector3f turned(sign, sign, 1);
  const std::string header = header_of(image, notes, turned).bytes();
  GzipWriter zipped(out);
  zipped.write(header.data(), header.size());
  const std::size_t nodes = image.values.size() / 3;
  std::vector<float> part;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t first = 0; first < nodes; first += floats_per_call) {
      part.resize(std::min(floats_per_call, nodes - first));
      for (std::size_t n = 0; n < part.size(); ++n)
        part[n] = turned[static_cast<Eigen::Index>(axis)] * image.values[3 * (first + n) + axis];
      zipped.write(part.data(), part.size() * sizeof(float));
    }
  zipped.finish();
}

}  // namespace bespoke
