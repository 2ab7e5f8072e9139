// Motion and light of one platform: what neither tells alone. The motion is integrated in
// rigid_body_recording.h, the light is that of the maker of `prove`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "diagnosis/light/beliefs.h"
#include "diagnosis/light/together.h"
#include "scenes/experiment/experiment.h"
#include "tests/diagnosis/named.h"
#include "tests/diagnosis/rigid_body_recording.h"
#include "tools/proof/light/files.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;
using namespace injected;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

// Nine lamps a metre above a plate of 6 × 3 cells.
LightCase bench() {
  LightCase c;
  c.seed = 16;
  c.sources =
      "[[source]]\nkind = \"led_array\"\nlayout = \"grid\"\ncount = [3, 3]\n"
      "pitch_m = [0.12, 0.06]\nposition_m = [0.01, -0.005, 1]\ndirection = [0, 0, -1]\n"
      "power_W = 6\naperture_diameter_m = 0.018\nprofile = \"gaussian\"\nfwhm_deg = 9\n"
      "wavelength_nm = 730\nspectral_fwhm_nm = 20\n\n";
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      InjectedLamp lamp;
      lamp.position_m = {0.01 + 0.12 * i, -0.005 + 0.06 * j, 1.0};
      lamp.power_W = 6.0;
      lamp.radius_m = 0.009;
      lamp.fwhm_rad = 9.0 * degree_rad;
      c.believed.light.lamps.push_back(lamp);
    }
  }
  c.believed.light.plate = {-0.15, 0.15, -0.075, 0.075, 0.15};
  InjectedCircuit& a = c.believed.circuit;
  a.columns = 6;
  a.rows = 3;
  a.bypass_every = 3;
  a.cell_current.assign(a.cells(), 1.0);
  a.cell_light.assign(a.cells(), 1.0);
  a.string_open = {false};
  a.bypass_shorted.assign(a.bypasses(), false);
  c.noise.voltage_V = 0.004;
  c.noise.current_A = 0.002;
  return c;
}

// One recording of each kind to fit, and one held out.
class Together : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(testing::TempDir()) /
        (std::string("together_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    write_light_case(case_, folder_);
    experiment_.emplace(read_experiment(folder_ / "experiment.toml"));
    lab_.emplace(*experiment_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // What light shows is how the platform stood in truth; what is recorded of that has the camera's
  // noise, and is turned by `bias_rad`.
  LightRecording light_of(const Recording& motion, const std::vector<Quat>& truth,
                          unsigned seed) const {
    constexpr size_t every = 3;
    LightRows rows;
    rows.kind = LightRows::Kind::run;
    LightRecording recording;
    recording.kind = LightRecording::Kind::run;
    recording.name = "run" + std::to_string(seed) + ".csv";
    for (size_t i = 0; i < motion.rows(); i += every) {
      const Quat& q = truth[i];
      rows.attitude.push_back({q.w(), q.x(), q.y(), q.z()});
      rows.time_s.push_back(motion.time_s[i]);
      rows.temperature_K.push_back(298.15);
      recording.lab_from_body.push_back(seen(attitude_of(motion, i)));
    }
    recording.time_s = rows.time_s;
    recording.temperature_K = rows.temperature_K;
    recording.rows_read = static_cast<int64_t>(rows.size());
    const std::vector<double> read = injected_readings(world_, rows, false);
    RandomDraw draw(seed, 7);
    for (size_t i = 0; i < rows.size(); ++i) {
      recording.voltage_V.push_back(read[2 * i] + case_.noise.voltage_V * draw.normal());
      recording.current_A.push_back(read[2 * i + 1] + case_.noise.current_A * draw.normal());
    }
    return recording;
  }

  Diagnosis diagnosed() const {
    MotionRecorded motion{rigid_body::nominal_model(), {}, {}, {}};
    LightRecorded light{*lab_, {lab_->nominal(), {}}, {}, {}, {}};
    for (const unsigned seed : {1u, 2u}) {
      std::vector<Quat> truth(1000, Quat::Identity());
      NamedRecording moved = rigid_body::recorded(seed, [&](const rigid_body::State& s) -> Vec3 {
        // The step that begins with a row is the last to ask for its time.
        const double row = s.time_s / 0.2;
        if (std::abs(row - std::round(row)) < 1e-6) {
          truth[static_cast<size_t>(std::lround(row))] = s.lab_from_body;
        }
        return s.lab_from_body.conjugate() * draught_lab_N_m_;
      });
      (seed == 1 ? light.recordings : light.holdouts)
          .push_back(light_of(moved.recording, truth, seed));
      for (size_t i = 0; i < moved.recording.rows(); ++i) {
        const Quat q = seen(attitude_of(moved.recording, i));
        const double parts[] = {q.w(), q.x(), q.y(), q.z()};
        for (size_t k = 0; k < 4; ++k) moved.recording.channels[k].values[i] = parts[k];
      }
      (seed == 1 ? motion.recordings : motion.holdouts).push_back(std::move(moved));
    }
    return diagnose_together(std::move(motion), std::move(light));
  }

  LightCase case_ = bench();
  LightWorld world_ = case_.believed;
  Vec2 bias_rad_ = Vec2::Zero();
  Vec3 draught_lab_N_m_ = Vec3::Zero();

 private:
  static Quat attitude_of(const Recording& r, size_t i) {
    const auto part = [&](size_t k) { return r.channels[k].values[i]; };
    return {part(0), part(1), part(2), part(3)};
  }
  Quat seen(const Quat& truth) const {
    const Vec3 back(-bias_rad_.x(), -bias_rad_.y(), 0.0);
    if (back.norm() == 0.0) return truth;
    return Quat(Eigen::AngleAxisd(back.norm(), back.normalized())) * truth;
  }

  fs::path folder_;
  std::optional<Experiment> experiment_;
  std::optional<LightLab> lab_;
};

TEST_F(Together, NothingIsMissing) {
  const Diagnosis d = diagnosed();
  EXPECT_EQ(d.verdict, Verdict::consistent) << d.sentence;
  EXPECT_THAT(kinds_of(d), testing::IsEmpty());
  ASSERT_EQ(d.domains.size(), 2u);
  EXPECT_TRUE(d.priors_refined.empty() || d.priors_refined.back().key != tilt_belief);
}

// By the motion alone it could as well be a draught, by the light alone it could be dirt.
TEST_F(Together, ACameraThatIsNotLevel) {
  bias_rad_ = Vec2(1.2, -0.8) * degree_rad;
  const Diagnosis d = diagnosed();
  EXPECT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  EXPECT_THAT(kinds_of(d), UnorderedElementsAre("gravity_tilt", "attitude_bias")) << d.sentence;
  const FittedParameter &bias = parameter(d, "attitude_bias", "bias_deg"),
                        &tilt = parameter(d, "gravity_tilt", "tilt_rad");
  const double expected_deg[] = {1.2, -0.8};
  for (size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(bias.value[k], expected_deg[k], 5.0 * bias.sigma[k]);
    EXPECT_LT(bias.sigma[k], 0.1);
    EXPECT_NEAR(tilt.value[k], -expected_deg[k] * degree_rad, 5.0 * tilt.sigma[k]);
  }
  for (const FoundEffect& effect : d.effects) {
    EXPECT_EQ(effect.table, effect.kind == "gravity_tilt" ? "disturbance" : "effect");
  }
}

// As strong as a tilt of 0.8 deg: light says that the platform stands as it is recorded.
TEST_F(Together, ADraughtIsNoTilt) {
  draught_lab_N_m_ = {2.5e-5, -1.5e-5, 0.0};
  const Diagnosis d = diagnosed();
  EXPECT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  ASSERT_THAT(kinds_of(d), ElementsAre("room_draft")) << d.sentence;
  const FittedParameter& torque = parameter(d, "room_draft", "torque_lab_N_m");
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(torque.value[k], draught_lab_N_m_[static_cast<Eigen::Index>(k)],
                5.0 * torque.sigma[k]);
  }
}

TEST_F(Together, ACellIsNoTilt) {
  world_.circuit.cell_current[9] = 0.8;
  const Diagnosis d = diagnosed();
  EXPECT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  ASSERT_THAT(kinds_of(d), ElementsAre("cell_degraded")) << d.sentence;
  EXPECT_EQ(parameter(d, "cell_degraded", "index").value.at(0), 9.0);
  const FittedParameter& factor = parameter(d, "cell_degraded", "factor");
  EXPECT_NEAR(factor.value.at(0), 0.8, 5.0 * factor.sigma.at(0));
}

}  // namespace
}  // namespace photorque
