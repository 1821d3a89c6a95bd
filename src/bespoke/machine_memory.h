#pragma once

#include <cstddef>

namespace bespoke {

/// Bytes that this process may still take: what Linux calls available, or less where a control group says so
/// (containers, jobs of a cluster).
std::size_t available_memory();

}  // namespace bespoke
