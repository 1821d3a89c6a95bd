#pragma once

#include <string>
#include <vector>

#include "bespoke/types.h"
#include "support/run_program.h"

namespace bespoke::test {

/// What most tests of the command start from: source.obj and target.obj, two ellipsoids of other connectivity
/// and other rigid position, anchors.json with fourteen pairs, and product.obj, a grid around the source, in
/// a directory of its own.
class ExamplePair {
 public:
  ExamplePair();

  std::string file(const std::string& name) const { return (directory_ / name).string(); }
  bool has(const std::string& name) const { return std::filesystem::exists(directory_ / name); }
  /// Names of all files, sorted.
  std::vector<std::string> files() const;

  /// `bespoke fit` on the pair, writing `map`, with options that keep it short. Tests add their own.
  ProgramResult fit(const std::string& map, const std::vector<std::string>& extra = {}) const;
  /// `bespoke apply` of `map` to product.obj.
  ProgramResult apply(const std::string& map, const std::vector<std::string>& extra = {}) const;

 private:
  ScratchDirectory directory_;
};

/// Runs the built command.
ProgramResult bespoke(const std::vector<std::string>& arguments);

/// 3×n from the `v` lines of an OBJ file.
Points read_obj_points(const std::string& path);

/// How far a point moves at most when its coordinates are written as floats.
double float_rounding(const Points& points);

/// Length of the diagonal of the points' bounding box.
double extent(const Points& points);

/// The text of an OBJ file.
std::string obj_text(const Points& vertices, const Faces& faces);

}  // namespace bespoke::test
