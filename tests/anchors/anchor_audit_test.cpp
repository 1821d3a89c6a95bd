#include "bespoke/anchors/anchor_audit.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

Anchors bent(int count) {
  Anchors anchors;
  const Points x = test::random_points(count, 5);
  for (int i = 0; i < count; ++i) {
    const Vector3 a = x.col(i);
    anchors.pairs.push_back(
        {"p" + std::to_string(i), a, Vector3(1.2 * a[0] + 0.1 * a[1] * a[1], a[1], 0.9 * a[2])});
  }
  return anchors;
}

TEST(AuditAnchors, FindsNothingInASmoothSet) {
  const AnchorAudit audit = audit_anchors(bent(30));
  EXPECT_TRUE(audit.suspicious.empty());
  EXPECT_GT(audit.typical_distance.value(), 0);
}

TEST(AuditAnchors, NamesASwappedPair) {
  Anchors anchors = bent(30);
  std::swap(anchors.pairs[4].b, anchors.pairs[11].b);
  const AnchorAudit audit = audit_anchors(anchors);
  ASSERT_EQ(audit.suspicious.size(), 2u);
  for (const SuspiciousAnchor& anchor : audit.suspicious) {
    ASSERT_TRUE(anchor.swapped_with);
    EXPECT_EQ(anchor.index + *anchor.swapped_with, 15u);
  }
  const std::string text = to_string(audit, anchors);
  EXPECT_NE(text.find("\"p4\" lies"), std::string::npos);
  EXPECT_NE(text.find("swapped with \"p11\""), std::string::npos);
}

TEST(AuditAnchors, NamesAMisplacedPairAndHowFarOffItIs) {
  Anchors anchors = bent(30);
  anchors.pairs[7].b += Vector3(0, 0, 0.8);
  const AnchorAudit audit = audit_anchors(anchors);
  ASSERT_EQ(audit.suspicious.size(), 1u);
  EXPECT_EQ(audit.suspicious[0].name, "p7");
  EXPECT_FALSE(audit.suspicious[0].swapped_with);
  EXPECT_NEAR(audit.suspicious[0].distance, 0.8, 0.15);
}

TEST(AuditAnchors, APairFarAstrayHidesNoOther) {
  Anchors anchors = bent(30);
  anchors.pairs[7].b += Vector3(0, 0, 0.8);
  anchors.pairs[20].b += Vector3(1000, 0, 0);
  const AnchorAudit audit = audit_anchors(anchors);
  ASSERT_EQ(audit.suspicious.size(), 2u);
  EXPECT_EQ(audit.suspicious[0].name, "p20");
  EXPECT_EQ(audit.suspicious[1].name, "p7");
}

TEST(AuditAnchors, BearsFewCoplanarAndDuplicatePairs) {
  EXPECT_TRUE(audit_anchors({}).suspicious.empty());
  EXPECT_TRUE(audit_anchors(bent(7)).suspicious.empty());
  EXPECT_FALSE(audit_anchors(bent(7)).typical_distance);
  Anchors flat = bent(20);
  for (AnchorPair& pair : flat.pairs) pair.a[2] = pair.b[2] = 0;
  flat.pairs.push_back(flat.pairs.front());
  EXPECT_TRUE(audit_anchors(flat).suspicious.empty());
  flat.pairs[3].a[0] = std::nan("");
  EXPECT_THROW(audit_anchors(flat), InvalidInput);
}

}  // namespace
}  // namespace bespoke
