#include "bespoke/asset/detail/untrusted.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <mutex>
#include <new>
#include <string>

#include "bespoke/asset/grids/grid_conversion.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

using Clock = std::chrono::steady_clock;

// Address space and time allowed to the child, generous because sparse values compress by a factor of 100.
constexpr std::uint64_t base_memory = std::uint64_t{1} << 29;
constexpr std::uint64_t memory_per_byte = 512;
constexpr std::uint64_t largest_memory = std::uint64_t{8} << 30;
constexpr double base_seconds = 10;
constexpr double seconds_per_byte = 1e-7;
constexpr std::size_t longest_message = 1000;

enum Verdict : char { accepted = 'A', rejected = 'R' };

struct Limits {
  std::uint64_t memory;  // bytes beyond what the process has
  double seconds;
};

Limits limits_for(std::size_t bytes) {
  return {std::min(largest_memory, base_memory + memory_per_byte * bytes),
          base_seconds + seconds_per_byte * static_cast<double>(bytes)};
}

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  int get() const { return value_; }
  void close() {
    if (value_ >= 0) ::close(value_);
    value_ = -1;
  }

 private:
  int value_;
};

/// Kills and reaps the child whatever happens.
class Child {
 public:
  explicit Child(pid_t pid) : pid_(pid) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { end(); }

  /// The signal that ended it by itself, or 0.
  int end() {
    if (pid_ <= 0) return 0;
    int status = 0;
    ::kill(pid_, SIGKILL);
    pid_t reaped;
    do reaped = ::waitpid(pid_, &status, 0);
    while (reaped < 0 && errno == EINTR);
    const bool known = reaped == pid_ && WIFSIGNALED(status);
    pid_ = 0;
    return known ? WTERMSIG(status) : 0;
  }

  /// Waits for a child that has closed its pipe, so that `end` reports its own end and not ours.
  void wait_until(Clock::time_point deadline) {
    siginfo_t info{};
    while (Clock::now() < deadline) {
      if (::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) != 0) return;
      if (info.si_pid == pid_) return;
      ::usleep(500);
    }
  }

 private:
  pid_t pid_;
};

std::uint64_t address_space_in_use() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t pages = 0;
  file >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

bool write_all(int descriptor, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(descriptor, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    data += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

void set_limit(int resource, std::uint64_t value) {
  rlimit old{};
  ::getrlimit(static_cast<__rlimit_resource>(resource), &old);
  const rlimit limit{std::min<rlim_t>(value, old.rlim_max), std::min<rlim_t>(value, old.rlim_max)};
  ::setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

void confine(const Limits& limits, std::uint64_t address_space) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGINT, SIGTERM, SIGPIPE, SIGXCPU})
    ::signal(signal, SIG_DFL);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_AS, address_space + limits.memory);
  set_limit(RLIMIT_CPU, static_cast<std::uint64_t>(limits.seconds) + 1);
  set_limit(RLIMIT_FSIZE, 0);
  const int null = ::open("/dev/null", O_RDWR);
  if (null >= 0) {
    ::dup2(null, STDIN_FILENO);
    ::dup2(null, STDOUT_FILENO);
    ::dup2(null, STDERR_FILENO);
  }
}

std::string message_for(const std::exception& error) {
  return std::string(1, rejected) + std::string(error.what()).substr(0, longest_message);
}

[[noreturn]] void run_child(int pipe, std::string_view bytes) {
  std::string reply;
  try {
    reply = std::string(1, accepted) + to_bytes(stored_file_from_vdb(bytes));
  } catch (const std::bad_alloc&) {
    reply = std::string(1, rejected) + "requires more memory than a file of its size may";
  } catch (const std::exception& error) {
    reply = message_for(error);
  } catch (...) {
    reply = std::string(1, rejected) + "reading it failed";
  }
  const std::uint64_t size = reply.size();
  write_all(pipe, reinterpret_cast<const char*>(&size), sizeof size);
  write_all(pipe, reply.data(), reply.size());
  // No destructor and no exit handler of the parent may run here.
  ::_exit(0);
}

/// Fills `data`; false at the end of the pipe. Throws FormatError at the deadline.
bool read_all(int descriptor, char* data, std::size_t size, Clock::time_point deadline, double seconds) {
  while (size > 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0)
      throw FormatError("could not be read within " + std::to_string(static_cast<int>(seconds)) + " seconds");
    pollfd waiting{descriptor, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, static_cast<int>(std::min<long long>(left, 1000)));
    if (ready <= 0) continue;
    const ssize_t got = ::read(descriptor, data, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    data += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

std::string receive(Child& child, int descriptor, const Limits& limits) {
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(limits.seconds));
  const auto died = [&]() -> FormatError {
    child.wait_until(deadline);
    const int signal = child.end();
    return FormatError(signal == 0 ? "reading it ended early"
                                   : "reading it crashed (" + std::string(::strsignal(signal)) + ")");
  };
  std::uint64_t size = 0;
  if (!read_all(descriptor, reinterpret_cast<char*>(&size), sizeof size, deadline, limits.seconds))
    throw died();
  if (!(size >= 1 && size <= limits.memory)) throw FormatError("reading it went wrong");
  std::string reply;
  // Grows with what arrives, so that a wrong size costs nothing.
  constexpr std::size_t piece = std::size_t{1} << 24;
  while (reply.size() < size) {
    const std::size_t old = reply.size();
    reply.resize(old + std::min<std::size_t>(piece, size - old));
    if (!read_all(descriptor, reply.data() + old, reply.size() - old, deadline, limits.seconds)) throw died();
  }
  return reply;
}

}  // namespace

StoredFile stored_file_from_untrusted_vdb(std::string_view bytes) {
  // The child must find the registry of grid types filled: the lock around it may be held at the fork.
  initialize_vdb();
  const Limits limits = limits_for(bytes.size());
  const std::uint64_t address_space = address_space_in_use();

  int ends[2];
  pid_t pid = -1;
  int fork_error = 0;
  {
    // Two forks at a time would give each child the other's pipe, and no pipe would end with its child.
    static std::mutex one_fork_at_a_time;
    const std::lock_guard lock(one_fork_at_a_time);
    if (::pipe2(ends, O_CLOEXEC) != 0) throw FileError(std::string("pipe: ") + std::strerror(errno));
    // Alone, because OpenVDB destroys trees in parallel: in the child it would wait for workers that were
    // just stealing from this thread and are gone.
    run_alone([&] {
      pid = ::fork();
      fork_error = errno;
      if (pid != 0) return;
      ::close(ends[0]);
      confine(limits, address_space);
      run_child(ends[1], bytes);
    });
    ::close(ends[1]);
  }
  Descriptor pipe(ends[0]);
  if (pid < 0) throw FileError(std::string("fork: ") + std::strerror(fork_error));
  Child child(pid);
  const std::string reply = receive(child, pipe.get(), limits);
  if (reply[0] != accepted) throw FormatError(reply.substr(1, longest_message));
  try {
    return stored_file_from_bytes(std::string_view(reply).substr(1));
  } catch (const InvalidInput& error) {
    throw FormatError(std::string("reading it gave nonsense: ") + error.what());
  }
}

}  // namespace bespoke
