#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "seam_lines.h"

namespace bespoke {

/// A second reference model: the source's counterpart in another shape, connectivity and rigid position.
struct SampleTarget {
  std::string name;  ///< empty when the sample has one target; else for instance "94"
  TriangleMesh mesh;
  std::vector<AnchorPair> anchors;  ///< a on the source, b on this target
};

/// Something designed around the source, clear of its surface.
struct SampleProduct {
  std::string name;
  TriangleMesh mesh;
  SeamPlan seams = {};  ///< of what is made of cloth or leather
};

/// One of the paper's five examples, made of implicit surfaces. Centimetres; the source stands upright, y up,
/// facing z. References are closed and oriented outward.
struct Sample {
  std::string name;
  TriangleMesh source;
  std::vector<SampleProduct> products;
  std::vector<SampleTarget> targets;
};

/// "dress", "girths", "glasses", "glove", "shoe": examples I to V.
std::vector<std::string> sample_names();

/// Some seconds of work; the same mesh each time. Throws InvalidInput, which lists the names, for another
/// name.
Sample make_sample(const std::string& name);

/// Writes source.obj, target[_NAME].obj, anchors[_NAME].json, PRODUCT.obj and, of what is sewn,
/// PRODUCT_seams.json into directory/sample.name, which it makes if need be. Returns what it wrote. Throws
/// FileError.
std::vector<std::filesystem::path> write_sample(const Sample& sample, const std::filesystem::path& directory);

}  // namespace bespoke
