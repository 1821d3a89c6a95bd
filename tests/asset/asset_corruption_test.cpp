#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <random>
#include <thread>

#include "asset/small_asset.h"
#include "bespoke/asset/asset_io.h"
#include "bespoke/asset/detail/record_json.h"
#include "bespoke/asset/detail/trailer.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr int corruptions = 2000;

class Corruptor {
 public:
  explicit Corruptor(unsigned seed) : random_(seed) {}

  /// Bytes that differ from those given.
  std::string operator()(const std::string& sound) {
    std::string bytes = sound;
    while (bytes == sound) change(bytes);
    return bytes;
  }

 private:
  void change(std::string& bytes) {
    switch (below(6)) {
      case 0:
        return bytes.resize(below(bytes.size()));
      case 1:
        return flip_bits(bytes, 1);
      case 2:
        return flip_bits(bytes, 2 + below(30));
      case 3:
        return overwrite(bytes);
      case 4:
        return swap_blocks(bytes);
      default:
        return append_junk(bytes);
    }
  }
  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }

  void flip_bits(std::string& bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) bytes[below(bytes.size())] ^= static_cast<char>(1 << below(8));
  }
  void overwrite(std::string& bytes) {
    const std::size_t begin = below(bytes.size());
    const std::size_t end = std::min(bytes.size(), begin + 1 + below(600));
    const std::size_t kind = below(3);
    for (std::size_t i = begin; i < end; ++i)
      bytes[i] = static_cast<char>(kind == 0 ? 0 : kind == 1 ? 255 : below(256));
  }
  void swap_blocks(std::string& bytes) {
    const std::size_t length = 1 + below(bytes.size() / 2 - 1);
    const std::size_t first = below(bytes.size() - 2 * length + 1);
    const std::size_t second = first + length + below(bytes.size() - first - 2 * length + 1);
    std::swap_ranges(bytes.begin() + static_cast<std::ptrdiff_t>(first),
                     bytes.begin() + static_cast<std::ptrdiff_t>(first + length),
                     bytes.begin() + static_cast<std::ptrdiff_t>(second));
  }
  void append_junk(std::string& bytes) {
    for (std::size_t count = 1 + below(200); count > 0; --count)
      bytes.push_back(static_cast<char>(below(256)));
  }

  std::mt19937_64 random_;
};

void expect_one_line(const std::string& message) {
  EXPECT_LT(message.size(), 300u);
  EXPECT_TRUE(std::none_of(message.begin(), message.end(), [](char c) {
    return c == '\n' || c == '\r' || c == '\0';
  })) << message;
}

struct Outcome {
  int rejected = 0;
  int accepted = 0;
};

// Reads each file; what is accepted must be a valid asset.
Outcome read_all(const std::filesystem::path& path, const std::function<std::string(int)>& bytes,
                 const ReadAssetOptions& options, int count) {
  Outcome outcome;
  for (int i = 0; i < count; ++i) {
    test::write_text(path, bytes(i));
    try {
      require_valid(read_asset(path, options));
      ++outcome.accepted;
    } catch (const FormatError& error) {
      expect_one_line(error.what());
      ++outcome.rejected;
    }
  }
  return outcome;
}

class CorruptAsset : public testing::Test {
 protected:
  CorruptAsset() {
    Asset asset = test::tiny_asset();
    asset.exact_map = "exact";
    write_asset(path_, asset);
    sound_ = test::read_text(path_);
  }
  test::ScratchDirectory directory_;
  std::filesystem::path path_ = directory_ / "map.vdb";
  std::string sound_;
};

TEST_F(CorruptAsset, IsRejectedInOneLine) {
  Corruptor corrupt(1);
  const Outcome outcome = read_all(
      path_, [&](int) { return corrupt(sound_); }, {}, corruptions);
  EXPECT_EQ(outcome.accepted, 0);
  EXPECT_EQ(outcome.rejected, corruptions);
}

TEST_F(CorruptAsset, WellSealedNeitherCrashesNorHangsTheReaderThatTrustsNobody) {
  Corruptor corrupt(2);
  const AssetSections sections = unseal(sound_);
  const std::string vdb(sections.vdb);
  const auto bytes = [&](int) { return seal({corrupt(vdb), "exact"}); };
  const Outcome outcome = read_all(path_, bytes, {.untrusted = true}, corruptions);
  EXPECT_EQ(outcome.accepted + outcome.rejected, corruptions);
  RecordProperty("accepted", outcome.accepted);
}

// The fork must not depend on what other threads of the parent are doing.
TEST_F(CorruptAsset, IsJudgedUnderLoadAsWithout) {
  std::atomic<bool> done = false;
  std::thread load([&] {
    while (!done) parallel_for(1000, 1, [](std::size_t, std::size_t) { std::vector<double>(1000, 1.0); });
  });
  Corruptor corrupt(3);
  const std::string vdb(unseal(sound_).vdb);
  const auto bytes = [&](int i) { return i % 2 == 0 ? sound_ : seal({corrupt(vdb), ""}); };
  const Outcome outcome = read_all(path_, bytes, {.untrusted = true}, 200);
  done = true;
  load.join();
  EXPECT_GE(outcome.accepted, 100);
}

// Nor on what the workers that helped this thread before it forks are still doing.
TEST_F(CorruptAsset, IsJudgedRightAfterAParallelLoopAsWithout) {
  for (int i = 0; i < corruptions / 4; ++i) {
    parallel_for(64, 1, [](std::size_t, std::size_t) { std::vector<double>(1000, 1.0); });
    EXPECT_NO_THROW(read_asset(path_, {.untrusted = true})) << i;
  }
}

}  // namespace
}  // namespace bespoke
