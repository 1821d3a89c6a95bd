#pragma once

#include <vector>

#include "bespoke/pattern/garment.h"
#include "bespoke/pattern/piece.h"
#include "bespoke/pattern/seam_file.h"

namespace bespoke {

/// A garment's faces, cut along the lines of seams so that these run along edges.
struct FacesAlongLines {
  Faces faces;                     ///< vertices behind the garment's own are `added`
  std::vector<int> of_face;        ///< for every face the garment's own that it is a part of, ascending
  Points corner_weights;           ///< 3×3m: of every corner in that face
  std::vector<AddedVertex> added;  ///< on edges and where lines cross
  SeamFile seams;                  ///< with edges instead of lines
};

/// Each part of a line between successive points cuts its face straight through. Lines may cross; one that
/// ends in the face where it crosses another ends there. Throws
/// InvalidInput for points that lie in no common face, and for pairs of vertices without an edge.
FacesAlongLines faces_along_lines(const Garment& garment, const SeamFile& seams);

/// The garment, or another with the same faces, with these.
Garment cut_along(const Garment& garment, const FacesAlongLines& cut);

}  // namespace bespoke
