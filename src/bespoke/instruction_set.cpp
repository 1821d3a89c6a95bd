#include "bespoke/instruction_set.h"

#include <algorithm>
#include <atomic>
#include <string>

#include "bespoke/error.h"

namespace bespoke {
namespace {

std::atomic<InstructionSet>& current() {
  static std::atomic<InstructionSet> set = supported_instruction_sets().back();
  return set;
}

}  // namespace

std::vector<InstructionSet> supported_instruction_sets() {
  std::vector<InstructionSet> sets{InstructionSet::baseline};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) sets.push_back(InstructionSet::avx2);
  if (__builtin_cpu_supports("avx512f")) sets.push_back(InstructionSet::avx512);
#endif
  return sets;
}

InstructionSet instruction_set() { return current().load(std::memory_order_relaxed); }

void use_instruction_set(InstructionSet set) {
  const std::vector<InstructionSet> supported = supported_instruction_sets();
  if (std::find(supported.begin(), supported.end(), set) == supported.end())
    throw InvalidInput("instruction set " + std::to_string(static_cast<int>(set)) +
                       ": this machine does not support it");
  current().store(set, std::memory_order_relaxed);
}

}  // namespace bespoke
