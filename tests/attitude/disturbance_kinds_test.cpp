// Errors for kinds of disturbance that do not exist.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/attitude/disturbance_bench.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

TEST(Disturbances, UnknownKindIsOneClearLine) {
  EXPECT_THAT(refusal_of([&] { make(bench_model(), "bearing_drug"); }),
              testing::HasSubstr("bearing_drag"));
}

// A disturbance that sets the field, the rotation of the laboratory or the battery current for all
// others may be used only once.
TEST(Disturbances, ThatSetTheSameForAllAreRefusedTwice) {
  const std::string cage = "{kind = 'helmholtz_cage', field_lab_T = [1e-5, 0, 0]}",
                    orbit = "{kind = 'orbit', altitude_m = 5e5, inclination_deg = 50}",
                    rotation = "{kind = 'earth_rotation'}",
                    load = "{kind = 'power_balance', load_W = 10}";
  const AttitudeModel model = bench_model();
  const auto read = [&](const std::vector<std::string>& all) {
    return read_disturbances(settings_of("disturbance = [" + joined_text(all, ", ") + "]"),
                             context_of(model));
  };
  for (const auto& pair : std::vector<std::vector<std::string>>{
           {cage, cage}, {cage, orbit}, {orbit, cage}, {rotation, rotation}, {load, load}}) {
    EXPECT_THROW(read(pair), InputError);
  }
  EXPECT_EQ(read({cage, rotation, load}).size(), 3u);
}

}  // namespace
}  // namespace photorque
