#include "diagnosis/attitude/findings.h"

#include <gtest/gtest.h>

namespace photorque {
namespace {

// Three numbers: x − y is known to 2e-11, the third against their mean ten times worse, and the sum
// of all hardly.
Mat3 differences_alone() {
  const Vec3 all = Vec3::Ones() / std::sqrt(3.0), one = Vec3(1, -1, 0) / std::sqrt(2.0),
             other = Vec3(1, 1, -2) / std::sqrt(6.0);
  return 3e-14 * all * all.transpose() + 2e-22 * one * one.transpose() +
         2e-20 * other * other.transpose();
}

TEST(KnownTogether, StatesTheKnownDifferences) {
  // The error of x − y is √(2e-22 · 2) = 2.0e-11.
  EXPECT_EQ(known_together(Vec3(4.4e-10, 0, 2.2e-10), differences_alone()),
            "x − y = (4.40 ± 0.20)×10⁻¹⁰");
  EXPECT_EQ(known_together(Vec3(0, 4.4e-10, 2.2e-10), differences_alone()),
            "−x + y = (4.40 ± 0.20)×10⁻¹⁰");
}

TEST(KnownTogether, IsSilentWhereNothingOrEachIsKnown) {
  EXPECT_EQ(known_together(Vec3(2e-11, 0, 1e-11), differences_alone()), "");
  EXPECT_EQ(known_together(Vec3(1, 2, 3), Mat3::Identity() * 0.01), "");
  EXPECT_EQ(known_together(Vec3(1, -1, 0), Mat3::Identity()), "");
  EXPECT_EQ(known_together(Vec3::Zero(), Mat3::Zero()), "");
}

}  // namespace
}  // namespace photorque
