#pragma once

#include <filesystem>
#include <functional>

namespace bespoke {

/// Where new content is written before it has its name.
enum class TemporaryFile {
  unnamed_where_possible,  ///< Linux's O_TMPFILE: a process that is killed leaves nothing
  named,                   ///< for file systems without it, a hidden neighbour of the target
};

/// Gives `path` new content in one step: `write(temporary)` fills a file on the same file system, by a name
/// that says nothing about the target's; then the file is flushed to the disk and put in the place of `path`.
/// Whoever opens `path` sees the old content or the new one, never a part of it, and of two writers at a time
/// the later one's. A symbolic link is followed: what it points to is replaced. An existing file keeps its
/// permissions. When anything throws, the temporary is gone and `path` is as it was.
///
/// A process that is killed leaves a file of its own in one case of two. With unnamed temporaries: between
/// two system calls that replace an existing file, `.NAME.bespoke-new`, which the next writer of `path`
/// takes away. With named ones: `.NAME.….bespoke-part`, locked as long as its writer lives; the first
/// write of a process into a directory removes those that nobody holds.
///
/// `write` opens the file that it is given for writing. Throws FileError, and whatever `write` throws.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write,
                      TemporaryFile kind = TemporaryFile::unnamed_where_possible);

}  // namespace bespoke
