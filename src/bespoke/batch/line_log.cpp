#include "bespoke/batch/line_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {

LineLog::LineLog(std::filesystem::path path)
    : path_(std::move(path)),
      descriptor_(::open(path_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw FileError(path_.string() + ": " + std::strerror(errno));
}

LineLog::~LineLog() { ::close(descriptor_); }

void LineLog::append(const std::string& line) {
  const std::string whole = line + "\n";
  ssize_t written = 0;
  do written = ::write(descriptor_, whole.data(), whole.size());
  while (written < 0 && errno == EINTR);
  if (written != static_cast<ssize_t>(whole.size()))
    throw FileError(path_.string() + ": cannot be written" + (written < 0 ? "" : ", is the disk full?"));
}

}  // namespace bespoke
