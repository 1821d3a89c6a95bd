#include "bespoke/machine_memory.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>

namespace bespoke {
namespace {

std::optional<std::size_t> number_in(const std::string& path) {
  std::ifstream file(path);
  std::size_t number = 0;
  return file >> number ? std::optional(number) : std::nullopt;  // "max" is no number
}

std::size_t available_on_the_machine() {
  std::ifstream file("/proc/meminfo");
  for (std::string key, unit; file >> key;) {
    std::size_t kibibytes = 0;
    if (key == "MemAvailable:" && file >> kibibytes) return kibibytes * 1024;
    std::getline(file, unit);
  }
  return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
}

/// Of the control group (version 2) that this process is in, and of those around it.
std::optional<std::size_t> left_of_control_group() {
  std::ifstream file("/proc/self/cgroup");
  std::string line, group;
  while (std::getline(file, line))
    if (line.starts_with("0::")) group = line.substr(3);
  std::optional<std::size_t> least;
  for (;; group.erase(group.rfind('/'))) {
    const std::string directory = "/sys/fs/cgroup" + group;
    if (const auto limit = number_in(directory + "/memory.max")) {
      const std::size_t used = std::min(*limit, number_in(directory + "/memory.current").value_or(0));
      least = std::min(least.value_or(*limit), *limit - used);
    }
    if (group.find('/') == std::string::npos) return least;
  }
}

}  // namespace

std::size_t available_memory() {
  const std::size_t machine = available_on_the_machine();
  return std::min(machine, left_of_control_group().value_or(machine));
}

}  // namespace bespoke
