#pragma once

#include <iosfwd>

#include "bespoke/exchange/image_formats.h"

namespace bespoke {

/// VTK's XML, the numbers appended as they lie in memory.
void write_vti(std::ostream& out, const DisplacementImage& image, const ImageNotes& notes);

/// NRRD 5 with its header in the file, raw, in LPS.
void write_nrrd(std::ostream& out, const DisplacementImage& image, const ImageNotes& notes);

}  // namespace bespoke
