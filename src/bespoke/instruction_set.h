#pragma once

#include <utility>
#include <vector>

namespace bespoke {

/// What hot loops are compiled for, each including those before it.
enum class InstructionSet { baseline, avx2, avx512 };

/// What this machine can run, in the order above; `baseline` always.
std::vector<InstructionSet> supported_instruction_sets();

/// What hot loops run with: the most that this machine supports, unless restricted.
InstructionSet instruction_set();

/// From now on, in all threads. For tests and measurements: results do not depend on it. Throws InvalidInput
/// if the machine does not support it.
void use_instruction_set(InstructionSet set);

// Chosen by a switch rather than by target_clones, whose resolvers run before the sanitizers are ready and
// which no test can turn to another branch.
#if defined(__x86_64__)
template <class Loop, class... Arguments>
__attribute__((target("avx2"))) void run_with_avx2(Arguments&&... arguments) {
  Loop::run(std::forward<Arguments>(arguments)...);
}
template <class Loop, class... Arguments>
__attribute__((target("avx512f,prefer-vector-width=512"))) void run_with_avx512(Arguments&&... arguments) {
  Loop::run(std::forward<Arguments>(arguments)...);
}
#endif

/// Loop<set>::run(arguments...), compiled once for each instruction set and run with instruction_set(). `run`
/// is static and [[gnu::always_inline]]. It gives the same bits with all of them: nothing is contracted
/// (-ffp-contract=off), and the order of sums is written down.
template <template <InstructionSet> class Loop, class... Arguments>
void run_dispatched_by_set(Arguments&&... arguments) {
  switch (instruction_set()) {
#if defined(__x86_64__)
    case InstructionSet::avx512:
      return run_with_avx512<Loop<InstructionSet::avx512>>(std::forward<Arguments>(arguments)...);
    case InstructionSet::avx2:
      return run_with_avx2<Loop<InstructionSet::avx2>>(std::forward<Arguments>(arguments)...);
#endif
    default:
      return Loop<InstructionSet::baseline>::run(std::forward<Arguments>(arguments)...);
  }
}

/// A loop that is written alike for all of them.
template <class Loop>
struct OfAnySet {
  template <InstructionSet>
  using Of = Loop;
};

/// The same of a Loop that the compiler makes into vectors by itself.
template <class Loop, class... Arguments>
void run_dispatched(Arguments&&... arguments) {
  run_dispatched_by_set<OfAnySet<Loop>::template Of>(std::forward<Arguments>(arguments)...);
}

}  // namespace bespoke
