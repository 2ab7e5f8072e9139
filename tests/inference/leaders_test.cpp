// Selection of the explanations that are weighed against the held-out data.
#include <gtest/gtest.h>

#include "inference/weigh.h"

namespace photorque::inference {
namespace {

Explanation scored(double log_evidence, const char* objection = "") {
  Explanation e;
  e.log_evidence = log_evidence;
  e.objection = objection;
  return e;
}

TEST(Leaders, ForbiddenTrialsDoNotAffectTheMargin) {
  Thresholds::HeldOut limits;
  limits.within = 15.0;
  limits.max_leaders = 4;
  // The nominal model, one that drives where it should brake, two that may be, one far behind.
  const std::vector<Explanation> trials = {scored(0.0), scored(120.0, "negative"), scored(100.0),
                                           scored(90.0), scored(80.0)};
  EXPECT_EQ(leaders_among(trials, limits), (std::vector<size_t>{2, 3, 0}));
}

TEST(Leaders, AreTheNominalModelWhereAllElseIsForbidden) {
  const std::vector<Explanation> trials = {scored(0.0), scored(120.0, "negative")};
  EXPECT_EQ(leaders_among(trials, Thresholds::HeldOut{}), (std::vector<size_t>{0}));
}

}  // namespace
}  // namespace photorque::inference
