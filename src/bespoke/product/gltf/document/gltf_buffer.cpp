#include "bespoke/product/gltf/document/gltf_buffer.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// What is read, changed and written before the next: it fits into a core's cache.
constexpr std::size_t window_size = std::size_t{1} << 20;  // bytes

/// Bytes of a buffer, from `offset` on.
template <class Byte>
struct BufferPart {
  Byte* bytes;
  std::size_t offset, size;
};

/// Copies what the parts have in common.
void copy_common(const BufferPart<const char>& from, const BufferPart<char>& to) {
  const std::size_t begin = std::max(from.offset, to.offset),
                    end = std::min(from.offset + from.size, to.offset + to.size);
  if (begin < end)
    std::memcpy(to.bytes + (begin - to.offset), from.bytes + (begin - from.offset), end - begin);
}

void replace_bytes(const GltfRows& rows, std::size_t offset, char* to, std::size_t length) {
  if (rows.stride == rows.size)
    return copy_common({rows.bytes.get(), rows.offset, rows.count * rows.size}, {to, offset, length});
  const std::size_t end_of_first = rows.offset + rows.size;
  std::size_t row = offset < end_of_first ? 0 : (offset - end_of_first) / rows.stride + 1;
  for (; row < rows.count && rows.offset + row * rows.stride < offset + length; ++row)
    copy_common({rows.bytes.get() + row * rows.size, rows.offset + row * rows.stride, rows.size},
                {to, offset, length});
}

}  // namespace

GltfBuffer::GltfBuffer(std::string bytes)
    : held_(std::make_shared<const std::string>(std::move(bytes))),
      own_size_(held_->size()),
      size_(own_size_) {}

void GltfBuffer::read(std::size_t offset, char* to, std::size_t size) const {
  parallel_for(size, window_size, [&](std::size_t begin, std::size_t end) {
    read_window(offset + begin, to + begin, end - begin);
  });
}

void GltfBuffer::read_window(std::size_t offset, char* to, std::size_t size) const {
  const std::size_t own = offset < own_size_ ? std::min(size, own_size_ - offset) : 0;
  if (file_ != nullptr)
    file_->read(begin_ + offset, to, own);
  else if (own > 0)
    std::memcpy(to, held_->data() + offset, own);
  std::memset(to + own, 0, size - own);
  for (const GltfRows& rows : replaced_) replace_bytes(rows, offset, to, size);
}

std::string GltfBuffer::content() const {
  std::string bytes(size_, '\0');
  read(0, bytes.data(), size_);
  return bytes;
}

void GltfBuffer::write(OutputFile& output) const {
  std::string window(std::min(window_size, size_), '\0');
  for (std::size_t at = 0; at < size_; at += window.size()) {
    window.resize(std::min(window_size, size_ - at));
    read_window(at, window.data(), window.size());
    output.write(window);
  }
}

}  // namespace bespoke
