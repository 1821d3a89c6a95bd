#pragma once

#include <string_view>

#include "bespoke/asset/grids/stored_grid.h"

namespace bespoke {

/// stored_file_from_vdb in a forked child process under limits of memory and time, for bytes that another
/// party may have written to do harm: OpenVDB's parser then crashes there, not here, and what comes back over
/// the pipe is read with every length checked. The child runs OpenVDB's reader alone, no thread but its own.
/// Throws FormatError saying how the child ended; FileError when no child can be started.
StoredFile stored_file_from_untrusted_vdb(std::string_view bytes);

}  // namespace bespoke
