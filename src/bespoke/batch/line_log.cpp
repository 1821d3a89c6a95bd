#include "bespoke/batch/line_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/output_stream.h"

namespace bespoke {

LineLog::LineLog(std::filesystem::path path)
    : path_(std::move(path)),
      descriptor_(is_stream(path_) ? open_stream(path_)
                                   : ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw FileError(path_.string() + ": " + std::strerror(errno));
}

LineLog::~LineLog() { ::close(descriptor_); }

void LineLog::append(const std::string& line) { write_to_descriptor(descriptor_, line + "\n", path_); }

}  // namespace bespoke
