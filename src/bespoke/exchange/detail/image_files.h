#pragma once

#include <iosfwd>

#include "bespoke/exchange/image_formats.h"

namespace bespoke {

/// VTK's XML, the numbers appended as they lie in memory.
void write_vti(std::ostream& out, const DisplacementImage& image, const ImageNotes& notes);

/// NRRD 5 with its header in the file, raw, in LPS.
void write_nrrd(std::ostream& out, const DisplacementImage& image, const ImageNotes& notes);

/// NIfTI-1 with gzip around it: intent 1006 (displacement vectors), places and vectors in RAS. Throws
/// InvalidInput for more nodes along an axis than the format counts.
void write_nifti_gz(std::ostream& out, const DisplacementImage& image, const ImageNotes& notes);

/// OpenVDB, one grid `displacement`, in the models' own frame.
void write_vdb(std::ostream& out, const DisplacementImage& image, const ImageNotes& notes);

}  // namespace bespoke
