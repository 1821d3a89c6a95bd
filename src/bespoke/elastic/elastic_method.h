#pragma once

#include <array>

#include "bespoke/enum_names.h"

namespace bespoke {

enum class ElasticMethod {
  finite_elements,  ///< the map of least distortion, on the lattices that store it
  csrbf,            ///< the paper's, one scale (Eq. 16)
  multiscale,       ///< residual correction over halved scales
  diffeomorphic,    ///< the same layers composed, each a diffeomorphism
  pffd,             ///< the paper's p-FFD as printed (Eq. 18), with jumps
  pffd_smooth,      ///< p-FFD with weights that make it continuous
};

/// Which maps go by guides in space (space_guides.h) beside the surface.
enum class GuidedMaps {
  none,   ///< the surface alone is met, as printed
  steps,  ///< steps of a chain, whose turns space would follow less the farther it is from the surface
  all,
};
inline constexpr std::array guided_maps{Named<GuidedMaps>{"none", GuidedMaps::none},
                                        Named<GuidedMaps>{"steps", GuidedMaps::steps},
                                        Named<GuidedMaps>{"all", GuidedMaps::all}};

}  // namespace bespoke
