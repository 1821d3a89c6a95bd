#include "bespoke/mesh/require_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

std::string surface_complaint(const TriangleMesh& mesh) {
  return test::error_message<InvalidInput>([&] { require_surface(mesh, "source a.obj"); });
}

TEST(RequireSurface, RefusesFacesThatAreLinesOrPoints) {
  TriangleMesh mesh = shapes::triangle();
  EXPECT_EQ(surface_complaint(mesh), "accepted");
  mesh.vertices.col(2) = 2 * mesh.vertices.col(1) - mesh.vertices.col(0);
  require_valid(mesh, "source a.obj");
  EXPECT_THAT(surface_complaint(mesh), HasSubstr("source a.obj has no area"));
  EXPECT_THAT(surface_complaint({}), HasSubstr("source a.obj has no faces"));
}

}  // namespace
}  // namespace bespoke
