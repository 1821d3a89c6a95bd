#pragma once

#include <iosfwd>

#include "bespoke/product/carry/product_file.h"
#include "bespoke/product/model_pose.h"
#include "bespoke/product/product_io.h"

namespace bespoke {

/// The parts of read_product, one a format.
Product read_obj_faces(const InputFile& file);
Product read_ply_faces(const InputFile& file);
Product read_stl_faces(const InputFile& file);
Product read_off_faces(const InputFile& file);
Product read_gltf_faces(const InputFile& file);
Product read_stored_gltf_faces(const InputFile& file);  ///< skinned meshes in the pose that is stored
Product read_gltf_model_faces(const InputFile& file, ModelPose pose);  ///< of a model: without lines
Product read_3mf_faces(const InputFile& file);

/// What the writers are given: a product whose coordinates are finite and fit into their numbers.
struct WrittenFaces {
  const Product& product;
  Points normals;           ///< of the vertices, where the product has some
  bool as_doubles = false;  ///< floats would lose too much of the vertices
};

/// The parts of write_product, one a format.
void write_obj_faces(std::ostream& out, const WrittenFaces& faces);
void write_ply_faces(std::ostream& out, const WrittenFaces& faces);
void write_stl_faces(std::ostream& out, const WrittenFaces& faces);
void write_off_faces(std::ostream& out, const WrittenFaces& faces);
void write_3mf_faces(std::ostream& out, const WrittenFaces& faces);

}  // namespace bespoke
