// Direct light gathered, or left to the rays where that would take too long.
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class DirectRouteCommand : public CommandTest {};

TEST_F(DirectRouteCommand, ManyPairsAreLeftToTheRaysWithANote) {
  const std::string few_rays =
      "trace " + nominal_file + " --set trace.rays=65536 --verbose --out " + at("o");
  // 49 lamps over 640 × 640 bins: 2.01 s at 0.1 µs a pair.
  const Outcome left = succeed(few_rays + " --set receiver[0].bins=[640,640]");
  EXPECT_THAT(left.out, HasSubstr("by rays alone"));
  EXPECT_THAT(left.out, Not(HasSubstr("\n  direct light on solar_array: quadrature")));
  const Outcome gathered = succeed(few_rays);
  EXPECT_THAT(gathered.out, HasSubstr("\n  direct light on solar_array: quadrature"));
}

}  // namespace
}  // namespace photorque
