// The maker of light and power in `prove`: its light and its circuit against closed forms, its
// readings against the program's own forward model, and how indices are scored.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "core/constants.h"
#include "diagnosis/light/model/run.h"
#include "scenes/effects/stated.h"
#include "scenes/experiment/experiment.h"
#include "tools/proof/light/files.h"
#include "tools/scoring/score.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;
using namespace injected;

InjectedLight one_lamp(double exponent) {
  InjectedLight light;
  InjectedLamp lamp;
  lamp.position_m = {0.0, 0.0, 1.0};
  lamp.radius_m = 1e-4;
  lamp.power_W = 3.0;
  lamp.profile = InjectedLamp::Profile::cosine_power;
  lamp.exponent = exponent;
  light.lamps = {lamp};
  light.plate = {-0.1, 0.1, -0.1, 0.1, 0.0};
  return light;
}

// A small source of intensity (m + 1)/2π cosᵐ per watt at height h lights the plane by
// (m + 1)/2π cosᵐ⁺³/h² (J. H. Lambert's cosine and inverse square).
TEST(ProveLight, SmallLampFollowsTheInverseSquare) {
  const double m = 30.0;
  const InjectedLight light = one_lamp(m);
  const auto E = injected_light(light, {1, 0, 0, 0}, {{0.0, 0.0}, {0.08, 0.06}}, false);
  const double on_axis = 3.0 * (m + 1.0) / (2.0 * pi);
  EXPECT_NEAR(E[0] / on_axis, 1.0, 1e-5);
  const double cosine = 1.0 / std::sqrt(1.01);
  EXPECT_NEAR(E[1] / on_axis, std::pow(cosine, m + 3.0), 1e-5);
}

// Half of the aperture behind an edge: half of the light.
TEST(ProveLight, EdgeAcrossTheApertureHidesHalf) {
  InjectedLight light = one_lamp(2.0);
  light.lamps[0].radius_m = 0.01;
  const double open = injected_light(light, {1, 0, 0, 0}, {{0.0, 0.0}}, false)[0];
  light.boxes.push_back({false, {0.0, -1.0, 0.4}, {1.0, 1.0, 0.41}});
  const double half = injected_light(light, {1, 0, 0, 0}, {{0.0, 0.0}}, false)[0];
  EXPECT_NEAR(half / open, 0.5, 1e-3);
}

// An ideal cell (no shunt current to speak of) opens at a ln(1 + L/I₀), and a dark cell in series
// with a lit one leaves what its bypass diode lets through.
TEST(ProveLight, CircuitFollowsTheDiodeEquation) {
  InjectedCircuit circuit;
  circuit.columns = 2;
  circuit.rows = 1;
  circuit.bypass_every = 1;
  circuit.cell.series_ohm = 0.0;
  circuit.cell.shunt_ohm = 1e9;
  circuit.cell_current = circuit.cell_light = {1.0, 1.0};
  circuit.string_open = {false};
  circuit.bypass_shorted = {false, false};
  const LitCircuit even(circuit, {500.0, 500.0}, 298.15);
  const double light_A =
      500.0 * 0.0025 * 0.9 * 730e-9 * elementary_charge_C / (planck_J_s * speed_of_light_m_s);
  const double thermal_V = boltzmann_J_K * 298.15 / elementary_charge_C;
  const double open_V = 2.0 * thermal_V * std::log1p(light_A / 1e-11);
  EXPECT_NEAR(even.open_voltage_V(), open_V, 1e-6);
  EXPECT_NEAR(even.current_A(0.0), light_A, 1e-6);
  const LitCircuit shaded(circuit, {500.0, 0.0}, 298.15);
  const double one_V = thermal_V * std::log1p((light_A - 0.3) / 1e-11);
  EXPECT_NEAR(shaded.current_A(one_V - circuit.drop_V), 0.3, 1e-6);
}

fs::path written_case(const LightPlan& plan, size_t index) {
  const fs::path folder = fs::path(testing::TempDir()) / ("light_case_" + std::to_string(index));
  write_light_case(draw_light_case(plan, index), folder);
  return folder;
}

// Of every recording in the folder, χ² over the readings about what the program predicts of an
// experiment as it stands: one, within four standard errors, where both know the same.
void expect_agreement(const fs::path& folder, const char* experiment_file,
                      std::set<LightRecording::Kind>& seen) {
  const Experiment experiment = read_experiment(folder / experiment_file);
  const LightLab lab(experiment);
  for (const auto& file : fs::directory_iterator(folder)) {
    if (file.path().extension() != ".gz") continue;
    const LightRun run(lab, read_light_recording(file.path(), {Quat::Identity(), 298.15}));
    seen.insert(run.recording().kind);
    LightState state = stated_effects(lab.experiment(), lab.parts());
    // The tracker of the recording held out is free.
    if (file.path().stem().stem().string().back() == '2') state.trapped.clear();
    const Eigen::VectorXd r =
        run.residuals(state, run.signals(state, run.fields(state, nullptr)), nullptr);
    const auto n = static_cast<double>(run.samples());
    // Where two maxima are as high as each other, either is right: few such readings count little.
    const double chi2 = r.cwiseAbs2().cwiseMin(25.0).sum();
    EXPECT_NEAR(chi2 / n, 1.0, 4.0 * std::sqrt(2.0 / n)) << file.path();
  }
}

TEST(ProveLight, MakerAndProgramAgreeWhereNothingIsMissing) {
  LightPlan plan;
  plan.per_kind = plan.pairs = plan.outside = plan.below = 0;
  plan.none = 6;
  plan.dirty_share = 0.0;
  std::set<LightRecording::Kind> seen;
  for (size_t i = 0; i < light_case_count(plan); ++i) {
    const fs::path folder = written_case(plan, i);
    expect_agreement(folder, "experiment.toml", seen);
    fs::remove_all(folder);
  }
  EXPECT_GE(seen.size(), 2u);
}

// With the truth told, likewise: of a shadow, of a glass beside a wall that shades cells in part,
// and of a tracker among maxima that change places.
TEST(ProveLight, MakerAndProgramAgreeWhereTheTruthIsTold) {
  LightPlan plan;
  plan.per_kind = 1;
  plan.dirty_share = 0.0;
  std::set<LightRecording::Kind> seen;
  for (const char* kind : {"unmodelled_shadow", "angular_response", "tracker_trapped"}) {
    SCOPED_TRACE(kind);
    const auto& kinds = injected_light_kinds();
    const auto index = static_cast<size_t>(std::ranges::find(kinds, kind) - kinds.begin());
    const LightCase c = draw_light_case(plan, index);
    ASSERT_EQ(c.effects.at(0).kind, kind);
    const fs::path folder = fs::path(testing::TempDir()) / kind;
    write_light_case(c, folder);
    expect_agreement(folder, "oracle.toml", seen);
    fs::remove_all(folder);
  }
  EXPECT_EQ(seen.size(), 3u);
}

// A cell that turns less light into current, as [[array.cell_override]] says it.
TEST(ProveLight, MakerAndProgramAgreeOnACellThatIsOverridden) {
  LightPlan plan;
  plan.per_kind = 1;
  plan.dirty_share = 0.0;
  const auto& kinds = injected_light_kinds();
  const auto index = static_cast<size_t>(std::ranges::find(kinds, "cell_degraded") - kinds.begin());
  const LightCase c = draw_light_case(plan, index);
  ASSERT_EQ(c.effects.at(0).kind, "cell_degraded");
  const fs::path folder = fs::path(testing::TempDir()) / "cell_override";
  write_light_case(c, folder);
  std::ofstream(folder / "experiment.toml", std::ios::app)
      << "\n[[array.cell_override]]\nindex = " << c.effects[0].index
      << "\nphotocurrent_factor = " << c.effects[0].numbers.at("factor").at(0) << '\n';
  std::set<LightRecording::Kind> seen;
  expect_agreement(folder, "experiment.toml", seen);
  EXPECT_FALSE(seen.empty());
  fs::remove_all(folder);
}

// Light beside a state that is known, and rows of a scan that is known, are those found afresh.
TEST(ProveLight, KnownLightIsThatFoundAfresh) {
  // A setting with a wall; drawing an effect that shows would take long.
  LightCase c;
  c.seed = 16;
  RandomDraw draw(c.seed, 1);
  draw_light_setting(draw, c, {"interreflection"});
  c.verdict = "consistent";
  const fs::path folder = fs::path(testing::TempDir()) / "light_with_wall";
  write_light_case(c, folder);
  const Experiment experiment = read_experiment(folder / "experiment.toml");
  const LightLab lab(experiment);
  ASSERT_FALSE(lab.walls().empty());
  const LightRun run(lab, read_light_recording(folder / "scan1.csv.gz", {}));
  LightState state = lab.nominal();
  state.walls.push_back({0, 0.3, 0.0});
  const LightFields fields = run.fields(state, nullptr);
  const std::vector<double> light = run.light(state, fields);
  LightState other = state;
  other.lamp_power[0] = 0.4;
  other.lamp_aim[1] = Vec2(0.01, -0.02);
  const LightFields there = run.fields(other, &fields);
  const LightRun::KnownLight known{&state, &fields, &light};
  const std::vector<double> beside = run.light(other, there, &known),
                            afresh = run.light(other, run.fields(other, nullptr));
  ASSERT_EQ(beside.size(), afresh.size());
  const double brightest = *std::ranges::max_element(afresh);
  double changed = 0.0;
  for (size_t i = 0; i < afresh.size(); ++i) {
    EXPECT_NEAR(beside[i], afresh[i], 1e-12 * brightest);
    changed = std::max(changed, std::abs(afresh[i] - light[i]));
  }
  EXPECT_GT(changed, 1e-2 * brightest);
  const std::vector<size_t> rows = {3, 5, 8, 40};
  const LightRun part = run.part(rows);
  const std::vector<double> some = part.light(state, LightRun::part(fields, rows));
  ASSERT_EQ(some.size(), rows.size());
  for (size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(some[i], light[rows[i]]);
  EXPECT_EQ(part.circumstances()[3].irradiance, run.circumstances()[40].irradiance);
  fs::remove_all(folder);
}

TEST(ProveLight, DrawsTheSameCaseAgain) {
  LightPlan plan;
  plan.per_kind = 1;
  const LightCase a = draw_light_case(plan, 11), b = draw_light_case(plan, 11);
  ASSERT_EQ(a.effects.size(), 1u);
  EXPECT_EQ(a.effects[0].kind, "detector_gain");
  EXPECT_EQ(a.effects[0].numbers, b.effects[0].numbers);
  EXPECT_EQ(a.sources, b.sources);
  EXPECT_GT(a.chi2_gain, 60.0);
}

TEST(ProveLight, IndexOfALampIsScored) {
  const fs::path folder = fs::path(testing::TempDir()) / "light_score";
  fs::create_directories(folder);
  std::ofstream(folder / "truth.json")
      << R"({"verdict": "missing_physics", "effects": [{"kind": "led_aim", "index": 3}],
             "accept": [["led_aim"]], "accept_index": {"led_aim": [3, 5]}})";
  const auto scored = [&](int index) {
    std::ofstream(folder / "diagnosis.json")
        << R"({"verdict": "missing_physics", "confidence": 1, "effects": [{"kind": "led_aim",
               "probability": 1, "parameters": {"index": {"value": )"
        << index << "}}}]}";
    return score_case(folder, folder, {});
  };
  EXPECT_EQ(scored(5).indices, 1);
  EXPECT_EQ(scored(5).indices_right, 1);
  EXPECT_EQ(scored(4).indices_right, 0);
  EXPECT_TRUE(scored(4).right);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace photorque
