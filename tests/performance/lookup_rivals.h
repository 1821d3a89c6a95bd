#pragma once

#include <cstddef>
#include <memory>

#include "bespoke/lattice/pyramid.h"

namespace bespoke {

/// Another way to look up u. Thread-safe.
class LookUpRival {
 public:
  virtual ~LookUpRival() = default;

  /// Three doubles a point.
  virtual void look_up(const double* x, std::size_t count, double* u) const = 0;
};

/// One array of floats over the box, its voxels those of the finest level with which it takes at most 64 MB:
/// what a look-up costs that knows only one resolution and finds nodes by arithmetic.
std::shared_ptr<const LookUpRival> dense_array(const Pyramid& pyramid, const Box& box);

/// OpenVDB's BoxSampler with one accessor a level, summed over all levels.
std::shared_ptr<const LookUpRival> openvdb_box_sampler(const Pyramid& pyramid);

/// NanoVDB's trilinear sampler that caches the last cell, one a level, summed over all levels; null where
/// NanoVDB's headers (Debian 12: libnanovdb-dev) were not there.
std::shared_ptr<const LookUpRival> nanovdb_cached_sampler(const Pyramid& pyramid);

}  // namespace bespoke
