#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

namespace bespoke {

/// Where new content is written before it has its name.
enum class TemporaryFile {
  unnamed_where_possible,  ///< Linux's O_TMPFILE: a process that is killed leaves nothing
  named,                   ///< for file systems without it, a hidden neighbour of the target
};

/// Replaces the content of `path` in one step: `write(temporary)` fills a file beside it, which is flushed to
/// the disk and renamed. Readers see the old content or the new one; if anything throws, `path` is as it was.
/// Links are followed, permissions kept; into a stream (output_stream.h) the bytes are written afterwards. A
/// killed process may leave `.NAME.bespoke-new` or `.NAME.….bespoke-part`, which the next writer removes.
/// Throws FileError, and whatever `write` throws.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write,
                      TemporaryFile kind = TemporaryFile::unnamed_where_possible);

/// Takes away what write_atomically has written, where something later fails: a link's target, not the link,
/// and never a stream. A file that is not there is no error.
void remove_written(const std::filesystem::path& path);

/// Where temporaries for a file belong: in the directory that it is put into or, while it would be held
/// (below), in that of the held files; those for a stream in the system's directory for temporaries.
std::filesystem::path directory_of_temporaries(const std::filesystem::path& path);

/// Makes a directory for outputs, and those above it; one that is there is no error. Throws FileError, which
/// names the file that is in its way.
void make_directories(const std::filesystem::path& directory);

/// Whether what this thread writes atomically is held: the directories of its files need not be there.
bool writes_are_held();

/// The directories that files are put into, to be flushed to the disk once for all of them. Before that, a
/// power failure may take new names away, or bring old content back, but never leaves a part of a file.
/// Thread-safe.
class LateDirectories {
 public:
  /// Calls `body`; the directories of what it writes atomically on this thread are noted, not flushed.
  void note(const std::function<void()>& body);

  /// Flushes what was noted. Throws FileError.
  void flush();

 private:
  friend void write_atomically(const std::filesystem::path&,
                               const std::function<void(const std::filesystem::path&)>&, TemporaryFile);
  void add(const std::filesystem::path& directory);

  std::mutex mutex_;
  std::set<std::filesystem::path> directories_;
};

/// Files that were written atomically but not put into place: whoever holds them may put them elsewhere. They
/// have no names where the file system allows that, are not flushed to the disk, and are gone with the
/// object.
class HeldFiles {
 public:
  struct File {
    std::filesystem::path path;     ///< where it would be
    std::filesystem::path content;  ///< by which this process can read it
  };

  /// `directory` is where they lie.
  explicit HeldFiles(std::filesystem::path directory);
  ~HeldFiles();
  HeldFiles(const HeldFiles&) = delete;
  HeldFiles& operator=(const HeldFiles&) = delete;

  /// Calls body(), and holds what it writes atomically on this thread. What is in the file system by the same
  /// names stays as it is.
  void hold(const std::function<void()>& body);

  /// In the order of writing; of a path the last.
  std::vector<File> files() const;

 private:
  struct Content;
  friend void write_atomically(const std::filesystem::path&,
                               const std::function<void(const std::filesystem::path&)>&, TemporaryFile);
  friend void remove_written(const std::filesystem::path&);
  friend std::filesystem::path directory_of_temporaries(const std::filesystem::path&);

  void write(const std::filesystem::path& path,
             const std::function<void(const std::filesystem::path&)>& write, TemporaryFile kind);
  void remove(const std::filesystem::path& path);

  std::filesystem::path directory_;
  std::vector<std::unique_ptr<Content>> contents_;
};

}  // namespace bespoke
