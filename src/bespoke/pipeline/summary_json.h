#pragma once

#include <nlohmann/json.hpp>

#include "bespoke/bake/bake.h"
#include "bespoke/certificate/certificate.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/statistics.h"
#include "bespoke/types.h"

namespace bespoke {

/// Summaries as JSON objects, without times, so that they may enter an asset. Keys keep their order.
using Json = nlohmann::ordered_json;

Json to_json(const Vector3& vector);
Json to_json(const Matrix3& matrix);  ///< rows
Json to_json(const Box& box);         ///< {"min", "max"}
Json to_json(const Statistics& statistics);
Json to_json(const MeshFindings& findings);
Json to_json(const BakeSummary& summary);
Json to_json(const Certificate& certificate);

}  // namespace bespoke
