#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace bespoke {

/// A product's file, read by position, from several threads.
class InputFile {
 public:
  /// Throws FileError when the file cannot be opened or is none, FormatError when it is empty.
  explicit InputFile(std::filesystem::path path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }

  /// Throws FileError, also when the file has become shorter.
  void read(std::uint64_t offset, char* to, std::size_t size) const;
  std::string content() const;  ///< of all the file

  /// What `write` writes, as a file without a name in this directory, which messages call `name`. Throws
  /// FileError, and what `write` throws.
  static std::unique_ptr<InputFile> of_written(const std::filesystem::path& directory,
                                               std::filesystem::path name,
                                               const std::function<void(class OutputFile&)>& write);

 private:
  InputFile(int descriptor, std::filesystem::path name);

  std::filesystem::path path_;
  int descriptor_;
  std::uint64_t size_ = 0;
};

/// A file that is being written from its beginning to its end.
class OutputFile {
 public:
  /// `name` is what messages call it. Throws FileError.
  OutputFile(const std::filesystem::path& path, std::filesystem::path name);
  ~OutputFile();
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;

  const std::filesystem::path& name() const { return name_; }
  void write(std::string_view bytes);

 private:
  friend class InputFile;
  OutputFile(int descriptor, std::filesystem::path name) : name_(std::move(name)), descriptor_(descriptor) {}

  std::filesystem::path name_;
  int descriptor_;
};

/// Opens all of the files, gives them to `write`, and puts them into their places once it returns: all of
/// them or, when it throws, none. Throws FileError, and what `write` throws.
void write_outputs(const std::vector<std::filesystem::path>& paths,
                   const std::function<void(std::vector<OutputFile>&)>& write);

}  // namespace bespoke
