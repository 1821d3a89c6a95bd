#pragma once

#include <filesystem>
#include <string_view>

namespace bespoke {

/// Whether a path leads, through links, to a device, pipe or socket, or to an open file of this process
/// (/dev/stdout, /dev/fd/N). Content is written into a stream; it is never replaced and never removed.
bool is_stream(const std::filesystem::path& path);

/// Refuses a stream that content must not or cannot be written into: block devices and sockets, unless this
/// process has them open. Throws FileError.
void require_writable_stream(const std::filesystem::path& path);

/// Opens a stream for writing; the caller closes the descriptor. A pipe that nobody reads is waited for, as
/// shells do. Throws FileError; Interrupted where a signal ends the wait.
int open_stream(const std::filesystem::path& path);

/// Writes all bytes to a descriptor, whose messages call it `name`. Throws FileError.
void write_to_descriptor(int descriptor, std::string_view bytes, const std::filesystem::path& name);

}  // namespace bespoke
