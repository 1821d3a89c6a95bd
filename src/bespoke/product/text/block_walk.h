#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "bespoke/parallel.h"
#include "bespoke/product/carry/product_file.h"
#include "bespoke/progress.h"

namespace bespoke {

/// Bytes of a file from `offset` on.
struct Window {
  std::string_view bytes;
  std::uint64_t offset = 0;
  bool is_last = false;  ///< the file ends here
};

/// What walk_blocks does.
template <class Cut, class Work, class Merge>
class BlockWalk {
 public:
  BlockWalk(const InputFile& file, const Cut& cut, const Work& work, const Merge& merge)
      : file_(file), cut_(cut), work_(work), merge_(merge) {}

  void run(std::uint64_t begin, const Progress& progress) {
    Wave before, start;
    start.offset = begin;
    Wave now = read_after(start);
    while (true) {
      progress.check();
      const bool is_last = now.blocks.empty() || now.failure;
      Wave next;
      // The first task keeps the order of the file; the others need none.
      parallel_for(now.blocks.size() + 1, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
          if (i > 0) {
            work_on(now, i - 1);
            continue;
          }
          merge_all(before);
          if (!is_last) next = read_after(now);
        }
      });
      if (is_last) break;
      before = std::move(now);
      now = std::move(next);
    }
    merge_all(now);
  }

 private:
  using Block = typename std::invoke_result_t<Cut, const Window&>::value_type;
  using Result = std::invoke_result_t<Work, const Block&>;
  static constexpr std::size_t wave_size = std::size_t{1} << 24;  // bytes, of some blocks a thread

  struct Wave {
    std::unique_ptr<char[]> buffer;
    std::uint64_t offset = 0;  ///< in the file, of the first byte behind the blocks
    std::string_view rest;
    std::vector<Block> blocks;
    std::vector<std::optional<Result>> results;
    std::vector<std::exception_ptr> failures;
    std::exception_ptr failure;  ///< of reading and cutting, behind the blocks
  };

  /// Exceptions wait until what comes before them in the file is merged.
  Wave read_after(const Wave& before) const {
    Wave wave;
    wave.offset = before.offset;
    try {
      std::size_t size = wave_size;
      while (!read_blocks(before, size, wave)) size *= 2;
    } catch (...) {
      wave.failure = std::current_exception();
    }
    wave.results.resize(wave.blocks.size());
    wave.failures.resize(wave.blocks.size());
    return wave;
  }

  /// What was left over and `size` more bytes; false where these hold no whole block and more could.
  bool read_blocks(const Wave& before, std::size_t size, Wave& wave) const {
    const std::uint64_t left = file_.size() - before.offset;
    const auto whole = static_cast<std::size_t>(std::min<std::uint64_t>(left, before.rest.size() + size));
    if (whole == 0) {
      cut_(Window{{}, before.offset, true});  // which may miss something
      return true;
    }
    wave.buffer = std::make_unique_for_overwrite<char[]>(whole);
    std::copy(before.rest.begin(), before.rest.end(), wave.buffer.get());
    file_.read(before.offset + before.rest.size(), wave.buffer.get() + before.rest.size(),
               whole - before.rest.size());
    const std::string_view bytes(wave.buffer.get(), whole);
    wave.blocks = cut_(Window{bytes, before.offset, whole == left});
    std::size_t used = 0;
    for (const Block& block : wave.blocks) used += block.bytes.size();
    wave.rest = bytes.substr(used);
    wave.offset = before.offset + used;
    return used > 0 || whole == left;
  }

  void work_on(Wave& wave, std::size_t block) const {
    try {
      wave.results[block] = work_(wave.blocks[block]);
    } catch (...) {
      wave.failures[block] = std::current_exception();
    }
  }

  void merge_all(Wave& wave) const {
    for (std::size_t i = 0; i < wave.blocks.size(); ++i) {
      if (wave.failures[i]) std::rethrow_exception(wave.failures[i]);
      merge_(wave.blocks[i], std::move(*wave.results[i]));
    }
    if (wave.failure) std::rethrow_exception(wave.failure);
  }

  const InputFile& file_;
  const Cut& cut_;
  const Work& work_;
  const Merge& merge_;
};

/// A file from a byte on.
struct FileFrom {
  const InputFile& file;
  std::uint64_t begin = 0;
};

/// Reads a file in waves of blocks: reading one, working on the one before and merging the one
/// before that overlap. cut(window) returns the whole blocks that the window begins with, each with its
/// `bytes` (what is left is shown again with more behind it; nothing may be left of the last). work(block)
/// runs on all threads; cut and merge(block, result) in the order of the file. The exception of the first
/// failing block is thrown, at any number of threads.
template <class Cut, class Work, class Merge>
void walk_blocks(const FileFrom& from, const Cut& cut, const Work& work, const Merge& merge,
                 const Progress& progress) {
  BlockWalk<Cut, Work, Merge>(from.file, cut, work, merge).run(from.begin, progress);
}

}  // namespace bespoke
