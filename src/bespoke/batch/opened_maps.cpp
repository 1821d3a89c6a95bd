#include "bespoke/batch/opened_maps.h"

namespace bespoke {

std::shared_ptr<const OpenedMap> OpenedMaps::open(const std::filesystem::path& path, MapForm form,
                                                  const ReadAssetOptions& options) {
  const Key key{path, form};
  std::promise<std::shared_ptr<const OpenedMap>> promise;
  Entry entry;
  bool is_mine = false;
  {
    const std::lock_guard lock(mutex_);
    const auto [known, is_new] = maps_.try_emplace(key, promise.get_future().share());
    entry = known->second;
    is_mine = is_new;
  }
  if (is_mine) {
    try {
      promise.set_value(std::make_shared<const OpenedMap>(open_map(path, form, options)));
    } catch (...) {
      promise.set_exception(std::current_exception());
      const std::lock_guard lock(mutex_);
      maps_.erase(key);
    }
  }
  return entry.get();
}

void OpenedMaps::close(const std::filesystem::path& path) {
  const std::lock_guard lock(mutex_);
  for (const MapForm form : {MapForm::grids, MapForm::exact, MapForm::inverse}) maps_.erase({path, form});
}

}  // namespace bespoke
