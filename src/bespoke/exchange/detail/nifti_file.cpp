#include <nifti/nifti1.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <ostream>
#include <string_view>

#include "bespoke/error.h"
#include "bespoke/exchange/detail/image_files.h"

namespace bespoke {
namespace {

constexpr char no_extension[4] = {};  // what follows the header
constexpr int gzip_window = 15 + 16;  // zlib's largest, and 16 for a gzip header, which then holds no time
constexpr std::size_t floats_per_call = std::size_t{1} << 18;

std::int16_t node_count(std::size_t nodes) {
  if (nodes > std::numeric_limits<std::int16_t>::max())
    throw InvalidInput(std::to_string(nodes) +
                       " nodes along an axis: NIfTI holds 32767; a larger --grid, or another format");
  return static_cast<std::int16_t>(nodes);
}

/// `turned` is -1 on the axes that point the other way in RAS.
nifti_1_header header_of(const DisplacementImage& image, const ImageNotes& notes,
                         const Eigen::Vector3f& turned) {
  nifti_1_header header{};
  header.sizeof_hdr = sizeof header;
  const std::array<std::int16_t, 8> dim{
      5, node_count(image.size[0]), node_count(image.size[1]), node_count(image.size[2]), 1, 3, 1, 1};
  std::copy(dim.begin(), dim.end(), header.dim);
  header.intent_code = NIFTI_INTENT_DISPVECT;
  header.datatype = NIFTI_TYPE_FLOAT32;
  header.bitpix = 32;
  const auto h = static_cast<float>(image.spacing);
  std::fill(std::begin(header.pixdim), std::end(header.pixdim), 1.0f);
  std::fill_n(header.pixdim + 1, 3, h);
  header.vox_offset = sizeof header + sizeof no_extension;
  header.scl_slope = 1;
  std::string_view(notes.content)
      .substr(0, sizeof header.descrip - 1)
      .copy(header.descrip, sizeof header.descrip);
  header.qform_code = header.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  // The quaternion's b, c, d: half a turn about z, or none.
  const Eigen::Vector3f origin = turned.cwiseProduct(image.origin.cast<float>());
  header.quatern_d = turned.x() < 0 ? 1.0f : 0.0f;
  header.qoffset_x = origin.x();
  header.qoffset_y = origin.y();
  header.qoffset_z = origin.z();
  header.srow_x[0] = turned.x() * h;
  header.srow_x[3] = origin.x();
  header.srow_y[1] = turned.y() * h;
  header.srow_y[3] = origin.y();
  header.srow_z[2] = turned.z() * h;
  header.srow_z[3] = origin.z();
  std::string_view("n+1").copy(header.magic, sizeof header.magic);
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
  const nifti_1_header header = header_of(image, notes, turned);
  GzipWriter zipped(out);
  zipped.write(&header, sizeof header);
  zipped.write(no_extension, sizeof no_extension);
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
