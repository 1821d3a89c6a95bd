#pragma once

#include <filesystem>
#include <functional>

namespace bespoke {

/// Gives `path` new content in one step: `write(temporary)` fills a file in the same directory, whose name
/// starts with a dot and has the ending of `path` (so that a writer that picks the format by the ending
/// works); then the file is flushed to the disk and renamed over `path`. Whoever opens `path` sees the old
/// content or the new one, never a part of it. A symbolic link is followed: what it points to is replaced. An
/// existing file keeps its permissions. When anything throws, the temporary is removed and `path` is as it
/// was. `write` creates or truncates the file that it is given. Throws FileError, and whatever `write`
/// throws.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

}  // namespace bespoke
