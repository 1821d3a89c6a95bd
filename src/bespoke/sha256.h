#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

namespace bespoke {

/// SHA-256 of bytes that arrive in pieces.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void update(const void* data, std::size_t bytes);

  /// The digest of everything so far, 64 lower-case hexadecimal digits; starts anew.
  std::string finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The digest of one block of memory, 64 lower-case hexadecimal digits.
std::string sha256(const void* data, std::size_t bytes);

/// The digest of a file's bytes. Throws FileError when it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace bespoke
