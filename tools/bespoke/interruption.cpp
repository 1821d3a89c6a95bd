#include "interruption.h"

#include <atomic>
#include <csignal>

namespace bespoke::command {
namespace {

std::atomic<int> received{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

extern "C" void remember(int signal) { received.store(signal); }

}  // namespace

void remember_interruptions() {
  struct sigaction action {};
  action.sa_handler = remember;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A reader that goes is an error of writing, which takes other outputs back.
  std::signal(SIGPIPE, SIG_IGN);
}

int interruption() { return received.load(); }

}  // namespace bespoke::command
