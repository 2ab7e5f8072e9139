// What is said of kinds of disturbance that are none.
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

TEST(Disturbances, UnknownKindIsOneClearLine) {
  try {
    make(bench_model(), "bearing_drug", {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("bearing_drag"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace photorque
