#pragma once

#include <filesystem>

#include "bespoke/asset/asset.h"

namespace bespoke {

struct ReadAssetOptions {
  /// Check the file in a child process under memory and time limits first, so that a malicious author cannot
  /// take the caller down.
  bool untrusted = false;
};

/// Verifies the trailer's SHA-256 before OpenVDB sees the file, then everything else that version 1 promises.
/// Throws FileError when the file cannot be read, MemoryLimitError when it is too large for the machine,
/// FormatError, naming the file and the reason in one line, for all that it cannot verify.
Asset read_asset(const std::filesystem::path& path, const ReadAssetOptions& options = {});

/// Atomic (temporary file beside the target, fsync, rename); the same asset gives the same bytes. Throws
/// FileError.
void write_asset(const std::filesystem::path& path, const Asset& asset);

}  // namespace bespoke
