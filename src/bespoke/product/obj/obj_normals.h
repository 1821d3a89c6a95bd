#pragma once

#include <cstdint>
#include <vector>

#include "bespoke/product/obj/obj_check.h"
#include "bespoke/product/point_motion.h"

namespace bespoke {

/// Where the normals of an OBJ file go. A normal of several positions is one line as long as the positions
/// agree about where it goes, and one line for each place otherwise; later normals then move up.
class ObjNormals {
 public:
  /// Reads the positions, and decides which normals become several. `content` and `motion` must outlive it.
  ObjNormals(const InputFile& file, const ObjContent& content, const PointMotion& motion,
             const Progress& progress);

  int decimals() const { return decimals_; }

  /// Whether any normal becomes several in the frame, so that corners name other numbers.
  bool renumbers(std::size_t frame) const { return !frames_[frame].first_line.empty(); }

  /// The number, from 0, of the line that a corner names which named `normal` and `position`, from 0.
  std::uint32_t line(std::size_t frame, std::uint32_t normal, std::uint32_t position) const;

  /// How many lines the first `normals` become.
  std::uint32_t lines_before(std::size_t frame, std::uint32_t normals) const;

  /// Images of the columns of `normals` (3×n), which are numbers [first, first + n) of the file: for every
  /// frame and normal one column for each line that it becomes; none for one that nothing uses.
  std::vector<std::vector<Points>> moved(std::uint32_t first, const Points& normals) const;

 private:
  struct Frame {
    std::vector<std::uint32_t> first_line;  ///< of every normal, and of the one behind the last; or empty
    std::vector<std::uint32_t> rank;        ///< of every further use: which of the normal's lines
  };

  /// Normals at the positions that use them, normal by normal, the first use first.
  struct Uses {
    std::vector<Vector3> positions, normals;
  };

  void decide(const Points& normals, const Progress& progress);
  bool is_of_several(std::uint32_t normal) const { return more_start_[normal] != more_start_[normal + 1]; }
  void add_uses(std::uint32_t normal, const Vector3& direction, Uses& uses) const;
  std::vector<Points> images(const Uses& uses) const;
  void rank_uses(const std::vector<std::uint32_t>& normals, const Points& moved, Frame& frame,
                 std::vector<std::uint32_t>& lines) const;

  const ObjContent& content_;
  const PointMotion& motion_;
  Points positions_;                     ///< 3×n
  std::vector<std::size_t> more_start_;  ///< of every normal in content.more_uses
  std::vector<Frame> frames_;
  int decimals_ = 0;
};

}  // namespace bespoke
