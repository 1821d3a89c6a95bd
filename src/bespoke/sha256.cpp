#include "bespoke/sha256.h"

#include <openssl/evp.h>

#include <array>
#include <fstream>

#include "bespoke/error.h"

namespace bespoke {
namespace {

// Fails only where the machine's OpenSSL has no SHA-256, or no memory.
void require(bool succeeded) {
  if (!succeeded) throw Error("OpenSSL cannot compute SHA-256 on this machine");
}

}  // namespace

struct Sha256::State {
  State() : context(EVP_MD_CTX_new()) {
    require(context != nullptr);
    start();
  }
  ~State() { EVP_MD_CTX_free(context); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  void start() { require(EVP_DigestInit_ex(context, EVP_sha256(), nullptr) == 1); }

  EVP_MD_CTX* context;
};

Sha256::Sha256() : state_(std::make_unique<State>()) {}
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

void Sha256::update(const void* data, std::size_t bytes) {
  require(EVP_DigestUpdate(state_->context, data, bytes) == 1);
}

std::string Sha256::finish() {
  std::array<unsigned char, 32> digest;
  require(EVP_DigestFinal_ex(state_->context, digest.data(), nullptr) == 1);
  state_->start();
  std::string hex;
  hex.reserve(2 * digest.size());
  for (const unsigned char byte : digest) {
    hex += "0123456789abcdef"[byte >> 4];
    hex += "0123456789abcdef"[byte & 15];
  }
  return hex;
}

std::string sha256(const void* data, std::size_t bytes) {
  Sha256 hash;
  hash.update(data, bytes);
  return hash.finish();
}

std::string sha256_of_file(const std::filesystem::path& path) {
  constexpr std::streamsize block_bytes = 1 << 18;
  std::ifstream file(path, std::ios::binary);
  const auto block = std::make_unique_for_overwrite<char[]>(block_bytes);
  Sha256 hash;
  while (file) {
    file.read(block.get(), block_bytes);
    hash.update(block.get(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) throw FileError(path.string() + ": cannot be read");
  return hash.finish();
}

}  // namespace bespoke
