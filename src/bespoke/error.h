#pragma once

#include <stdexcept>
#include <string>

namespace bespoke {

/// Root of everything the library throws on purpose. The message is one line, names the value, file or line
/// at fault and says what to do.
class Error : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The caller's fault: an argument or a mesh that the method cannot work with.
class InvalidInput : public Error {
  using Error::Error;
};

/// A file cannot be opened, read, written or renamed.
class FileError : public Error {
  using Error::Error;
};

/// A file was read but its content is not what its format allows.
class FormatError : public Error {
  using Error::Error;
};

/// A numerical method did not succeed; the message carries the residual.
class SolverError : public Error {
  using Error::Error;
};

/// The work would need more memory than the caller allowed, or than there is.
class MemoryLimitError : public Error {
  using Error::Error;
};

/// The caller requested a stop (Progress::cancelled).
class Interrupted : public Error {
  using Error::Error;
};

}  // namespace bespoke
