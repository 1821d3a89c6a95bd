#pragma once

#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "bespoke/pipeline/open_map.h"

namespace bespoke {

/// Maps in memory, each opened once for all who carry products through it. Thread-safe.
class OpenedMaps {
 public:
  /// As open_map. A caller waits for a map that is being opened; one that cannot be opened is tried
  /// again by the next caller.
  std::shared_ptr<const OpenedMap> open(const std::filesystem::path& path, MapForm form,
                                        const ReadAssetOptions& options);

  /// Lets the map go, in all its forms, once its present users have.
  void close(const std::filesystem::path& path);

 private:
  using Key = std::pair<std::filesystem::path, MapForm>;
  using Entry = std::shared_future<std::shared_ptr<const OpenedMap>>;

  std::mutex mutex_;
  std::map<Key, Entry> maps_;
};

}  // namespace bespoke
