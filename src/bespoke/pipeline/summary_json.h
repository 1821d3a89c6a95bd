#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "bespoke/bake/bake.h"
#include "bespoke/certificate/certificate.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/registration/fit_summary.h"
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
Json to_json(const PointCloudSummary& summary);
Json to_json(const BakeSummary& summary);
Json to_json(const Certificate& certificate);
Json to_json(const UnanchoredSummary& summary);
Json to_json(const RigidSummary& summary);
Json to_json(const CoarseSummary& summary, const Anchors& anchors);
Json to_json(const SurfaceFitSummary& summary, SurfaceFitMethod method);
Json to_json(const ElasticSummary& summary);

/// One stage of a fit, with its name in front.
struct StageJson {
  Json json;
  double seconds = 0;
};

/// Those that ran, in their order. Anchors: those of the fit, for their names.
std::vector<StageJson> stages_json(const FitSummary& summary, const Anchors& anchors);

}  // namespace bespoke
