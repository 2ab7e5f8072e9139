// Direct light gathered, or left to the rays where that would take too long.
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string stasis_file = std::string(PHOTORQUE_SOURCE_DIR) + "/scenes/stasis/nominal.toml";

class DirectRouteCommand : public CommandTest {};

TEST_F(DirectRouteCommand, ManyPairsAreLeftToTheRaysWithANote) {
  const std::string many = "trace " + stasis_file + " --set trace.rays=65536" +
                           " --set receiver[0].bins=[800,800] --out " + at("o");
  const Outcome left = run(many);
  ASSERT_EQ(left.status, 0) << left.err;
  EXPECT_THAT(left.out, HasSubstr("by rays alone"));
  EXPECT_THAT(left.out, Not(HasSubstr("gathered and by rays differ by")));
  const Outcome gathered = run(many + " --set trace.direct=gather");
  ASSERT_EQ(gathered.status, 0) << gathered.err;
  EXPECT_THAT(gathered.out, HasSubstr("gathered and by rays differ by"));
}

}  // namespace
}  // namespace photorque
