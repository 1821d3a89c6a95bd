#pragma once

#include <vector>

#include "bespoke/product/carry_product.h"
#include "bespoke/product/detail/product_file.h"

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

}  // namespace bespoke
