#pragma once

#include "asset/small_asset.h"
#include "bespoke/bake/bake.h"
#include "support/analytic_map.h"

namespace bespoke::test {

/// A certified asset of the space around a sphere, baked to a tolerance (mesh units).
inline Asset baked_asset(const Vector3& amplitude, double tolerance) {
  const AnalyticMap map(
      {{Vector3(0.5, 0, 0), 1.0, amplitude}, {Vector3(-0.5, 0.3, 0), 0.8, 0.5 * amplitude}});
  BakeOptions options;
  options.tolerance = tolerance;
  options.error_points = 20000;
  Asset asset = small_asset();
  MapStep& step = asset.steps.front();
  step.affine = map.affine();
  Bake baked = bake(map, options);
  step.pyramid = std::move(baked.pyramid);
  step.certificate = certify(step.pyramid, step.affine);
  asset.record.tolerance = tolerance;
  asset.record.bake_error = baked.summary.error;
  return asset;
}

/// Two steps.
inline Asset chain_asset(double tolerance) {
  Asset asset = baked_asset({0.1, 0.2, 0}, tolerance);
  asset.steps.push_back(baked_asset({0.05, -0.1, 0.1}, tolerance).steps.front());
  asset.path = RotationPath::flow;
  return asset;
}

}  // namespace bespoke::test
