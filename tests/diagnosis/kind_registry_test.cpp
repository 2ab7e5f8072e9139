// The registry of disturbances against those who use it: what `diagnose` screens, `budget` ranks
// and docs/disturbances.md documents. Every exception is named here, and its reason
// stands in the kind's own file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "attitude/studies/budget.h"
#include "core/files.h"
#include "diagnosis/attitude/effects/trial.h"
#include "tests/attitude/disturbance_bench.h"

namespace photorque {
namespace {

using Names = std::set<std::string>;

// Kinds that a recording of motion does not show, or that an experiment cannot lack: see the
// reasons in their files.
const Names not_screened = {"actuator_latency",     "aerodynamic_drag", "empirical_torque",
                            "helmholtz_cage",       "mass_error",       "orbit",
                            "planet_light",         "power_balance",    "radiation_pressure",
                            "stepper_quantization", "wheel_control",    "wheel_imbalance"};
// Instruments exert no torque; an orbit is where others do; lamps press at an instant's current.
const Names not_ranked = {
    "actuator_latency", "attitude_latency",  "body_force",     "camera_misalignment",
    "gyro_bias",        "gyro_misalignment", "gyro_scale",     "lamp_pressure",
    "marker_positions", "mass_error",        "orbit",          "sliding_air_drag",
    "sliding_drag",     "sliding_friction",  "sliding_spring", "table_slope",
    "thrust_saturation"};
Names all_names() {
  Names names;
  for (const DisturbanceKind& kind : disturbance_kinds()) names.insert(kind.name);
  return names;
}

Names without(Names names, const Names& some) {
  for (const std::string& name : some) EXPECT_EQ(names.erase(name), 1u) << name;
  return names;
}

TEST(KindRegistry, DiagnoseScreensAllButTheExceptions) {
  Names screened;
  const AttitudeModel model = bench_model();
  for (const Effect& effect : catalogue(context_of(model))) screened.insert(effect.kind);
  EXPECT_EQ(screened, without(all_names(), not_screened));
}

TEST(KindRegistry, EveryExceptionHasAReasonAndNothingElse) {
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    const Screening& s = kind.screening;
    const bool is_screened = !s.parametrisations.empty() || s.of_experiment != nullptr;
    EXPECT_NE(is_screened, !s.reason_against.empty()) << kind.name;
    EXPECT_EQ(!kind.budget.reason_against.empty(), not_ranked.contains(kind.name)) << kind.name;
  }
}

TEST(KindRegistry, ConfusableKindsAreKinds) {
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    for (const ConfusableKind& like : kind.screening.confusable_kinds) {
      EXPECT_NE(find_kind(like.kind), nullptr) << kind.name << " is like " << like.kind;
    }
  }
}

// The assumptions of a fit agree with the law: its keys make the disturbance, and each starts
// within bounds.
TEST(KindRegistry, TheKeysOfAFitAreThoseOfTheLaw) {
  const AttitudeModel model = bench_model();
  for (const Effect& effect : catalogue(context_of(model))) {
    const Disturbance d = disturbance_of(effect, context_of(model));
    size_t numbers = 0;
    for (const EffectKey& key : effect.keys) {
      numbers += key.start.size();
      EXPECT_NO_THROW(index_of(d, key.key)) << effect.kind << "." << key.key;
      EXPECT_EQ(key.scale > 0.0, !key.is_fixed) << effect.kind << "." << key.key;
      for (const double start : key.start) {
        EXPECT_GE(start, key.lowest) << effect.kind << "." << key.key;
        EXPECT_LE(start, key.highest) << effect.kind << "." << key.key;
      }
    }
    EXPECT_EQ(numbers, d.parameters.size()) << effect.kind;
  }
}

TEST(KindRegistry, BudgetRanksAllButTheExceptions) {
  AttitudeModel model = bench_model();
  Names made;
  for (const Effect& effect : catalogue(context_of(model))) {
    if (!made.insert(effect.kind).second) continue;
    model.disturbances.push_back(disturbance_of(effect, context_of(model)));
  }
  Names ranked;
  const PlatformState state = Dynamics(model).initial_state();
  for (const BudgetEntry& entry : make_budget(model, state).entries) ranked.insert(entry.kind);
  for (const std::string& kind : made) {
    EXPECT_EQ(ranked.contains(kind), !not_ranked.contains(kind)) << kind;
  }
}

std::string page() {
  return read_file(PHOTORQUE_SOURCE_DIR "/docs/disturbances.md");
}

// Each kind has rows of keys, with every key of a fit.
TEST(KindRegistry, ThePageListsEveryKey) {
  const std::string text = page();
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    const size_t row = text.find("| **`" + kind.name + "`**");
    ASSERT_NE(row, std::string::npos) << kind.name;
    const size_t end = std::min(text.find("| **`", row + 5), text.find("\n\n", row));
    for (const Parametrisation& p : kind.screening.parametrisations) {
      for (const EffectKey& key : p.keys) {
        const std::string section = text.substr(row, end - row);
        EXPECT_THAT(section, testing::HasSubstr("`" + key.key + "`")) << kind.name;
      }
    }
  }
}

}  // namespace
}  // namespace photorque
