#pragma once

namespace bespoke::command {

/// From now on SIGINT and SIGTERM are remembered instead of ending the process; a second one ends it.
void remember_interruptions();

/// The signal that arrived, 0 when none did. Safe from any thread.
int interruption();

}  // namespace bespoke::command
