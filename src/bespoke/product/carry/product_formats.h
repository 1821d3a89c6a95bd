#pragma once

#include <string>
#include <vector>

#include "bespoke/product/carry/part_motion.h"
#include "bespoke/product/carry/product_file.h"
#include "bespoke/product/carry_product.h"

namespace bespoke {

/// The parts of carry_product, one a format: each reads `file` and fills one output a frame.
CarrySummary carry_obj(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress);
CarrySummary carry_ply(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress);
CarrySummary carry_stl(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress);
CarrySummary carry_off(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress);
CarrySummary carry_xyz(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress);
CarrySummary carry_csv(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress);
CarrySummary carry_gltf(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                        const Progress& progress);

/// The same of skinned meshes in the pose in which they are stored; as well below.
CarrySummary carry_stored_gltf(const InputFile& file, std::vector<OutputFile>& outputs,
                               const PointMotion& motion, const Progress& progress);

/// Writes the file with edges split (CarryOptions::splits). Throws FileError, FormatError, and InvalidInput
/// for what cannot be told of split faces.
void split_obj(const InputFile& file, const FaceSplits& splits, OutputFile& output);
void split_ply(const InputFile& file, const FaceSplits& splits, OutputFile& output);
void split_stl(const InputFile& file, const FaceSplits& splits, OutputFile& output);
void split_off(const InputFile& file, const FaceSplits& splits, OutputFile& output);
void split_gltf(const InputFile& file, const FaceSplits& splits, OutputFile& output);
void split_stored_gltf(const InputFile& file, const FaceSplits& splits, OutputFile& output);

/// The points of parts that keep their shape. Throws InvalidInput, listing the names that are known, for one
/// that is not, and what the reading of the file throws.
std::vector<PartPoints> find_obj_parts(const InputFile& file, const std::vector<RigidPart>& parts,
                                       const Progress& progress);
std::vector<PartPoints> find_ply_parts(const InputFile& file, const std::vector<RigidPart>& parts,
                                       const Progress& progress);
std::vector<PartPoints> find_gltf_parts(const InputFile& file, const std::vector<RigidPart>& parts,
                                        const Progress& progress);
std::vector<PartPoints> find_stored_gltf_parts(const InputFile& file, const std::vector<RigidPart>& parts,
                                               const Progress& progress);

/// The groups of vertex_groups (vertex_groups.h): of every position of the file; of the vertices, 3×n, in
/// that pose.
std::vector<std::string> find_obj_groups(const InputFile& file);
std::vector<std::string> find_gltf_groups(const InputFile& file, const Points& vertices, ModelPose pose);

}  // namespace bespoke
