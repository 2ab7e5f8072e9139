// Recordings that hold less than an attitude or three rates: angles in another sequence, a tilt and
// a heading, the length of a rate. Bodies are integrated in rigid_body_recording.h, or here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "attitude/estimation/conventions.h"
#include "attitude/estimation/segments.h"
#include "attitude/recordings/columns.h"
#include "tests/diagnosis/machine_bench.h"
#include "tests/diagnosis/rigid_body_recording.h"
#include "tests/noise.h"

namespace photorque {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

std::vector<double> components(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

// The recording of rigid_body_recording.h in other columns. `from`: the attitude as the camera saw
// it, row by row.
NamedRecording rewritten(NamedRecording run, const std::vector<std::string>& columns,
                         const std::function<std::vector<double>(const Quat&)>& from,
                         bool keeps_gyro) {
  Recording written = run.recording;
  written.channels.clear();
  for (const std::string& name : columns) written.channels.push_back({name, {}});
  const auto cell = [&](const char* name, size_t row) {
    return run.recording.find(name)->values[row];
  };
  for (size_t row = 0; row < run.recording.rows(); ++row) {
    const std::vector<double> values =
        from(Quat(cell("q_w", row), cell("q_x", row), cell("q_y", row), cell("q_z", row)));
    for (size_t c = 0; c < columns.size(); ++c) written.channels[c].values.push_back(values[c]);
  }
  for (const char* gyro : {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"}) {
    if (keeps_gyro) written.channels.push_back(*run.recording.find(gyro));
  }
  run.recording = written;
  return run;
}

Vec3 dipole_torque(const rigid_body::State& s) {
  return Vec3(0.03, -0.02, 0.04).cross(s.lab_from_body.conjugate() * rigid_body::field_lab_T);
}

TEST(ScalarReadings, SequencesOfAnglesAreThatOfTheirName) {
  // A quarter turn of roll, then one of pitch. With "xyz" the pitch is about the body's own y: body
  // z goes to x, which the roll leaves. With "zyx" the roll acts first: z goes to −y, and the pitch
  // leaves that.
  const Vec3 quarters(pi / 2, pi / 2, 0.0);
  EXPECT_NEAR((attitude_of_angles("xyz", quarters) * Vec3::UnitZ() - Vec3::UnitX()).norm(), 0.0,
              1e-15);
  EXPECT_NEAR((attitude_of_angles("zyx", quarters) * Vec3::UnitZ() + Vec3::UnitY()).norm(), 0.0,
              1e-15);
  const Vec3 angles(0.3, -0.7, 2.5);
  for (const std::string_view sequence : angle_sequences) {
    Vec3 of_sequence = angles;
    // The middle turn is the one within a right angle.
    std::swap(of_sequence[1], of_sequence[sequence[1] - 'x']);
    const Vec3 back = angles_of_attitude(sequence, attitude_of_angles(sequence, of_sequence));
    EXPECT_NEAR((back - of_sequence).norm(), 0.0, 1e-14) << sequence;
    // Upright: the attitude comes back although its angles are not unique.
    Vec3 upright = angles;
    upright[sequence[1] - 'x'] = -pi / 2;
    const Quat q = attitude_of_angles(sequence, upright);
    EXPECT_NEAR(q.angularDistance(attitude_of_angles(sequence, angles_of_attitude(sequence, q))),
                0.0, 1e-6)
        << sequence;
  }
}

double matrix_tilt(const Quat& at) {
  return std::acos(at.toRotationMatrix()(2, 2));
}
double matrix_yaw(const Quat& at) {
  const Mat3 m = at.toRotationMatrix();
  return std::atan2(m(1, 0), m(0, 0));
}

// Values from the rotation matrix; slopes by turning it.
TEST(ScalarReadings, SlopesAreThoseOfTheAngles) {
  const Quat q = Quat(0.8, -0.2, 0.35, 0.44).normalized();
  const Vec3 rate(0.3, -0.4, 1.2);
  EXPECT_NEAR(scalar_reading(Scalar::tilt, q, rate).value, matrix_tilt(q), 1e-14);
  EXPECT_NEAR(scalar_reading(Scalar::yaw, q, rate).value, matrix_yaw(q), 1e-14);
  for (int k = 0; k < 3; ++k) {
    constexpr double step = 1e-6;
    const Quat on = Quat(Eigen::AngleAxisd(step, Vec3::Unit(k))) * q,
               back = Quat(Eigen::AngleAxisd(-step, Vec3::Unit(k))) * q;
    EXPECT_NEAR(scalar_reading(Scalar::tilt, q, rate).by_rotation_lab[k],
                (matrix_tilt(on) - matrix_tilt(back)) / (2 * step), 1e-8);
    EXPECT_NEAR(scalar_reading(Scalar::yaw, q, rate).by_rotation_lab[k],
                (matrix_yaw(on) - matrix_yaw(back)) / (2 * step), 1e-8);
  }
  const ScalarReading length = scalar_reading(Scalar::rate_magnitude, q, rate);
  EXPECT_NEAR(length.value, 1.3, 1e-15);
  EXPECT_NEAR((length.by_rate - Vec3(3, -4, 12) / 13).norm(), 0.0, 1e-15);
  // A heading that has turned twice more is the same heading.
  EXPECT_NEAR(scalar_difference(Scalar::yaw, 4 * pi + 0.1, 0.0), 0.1, 1e-14);
}

TEST(ScalarReadings, AnglesInAnotherSequenceAreReadInTheirs) {
  const auto steep = [](const rigid_body::State& s) -> Vec3 { return dipole_torque(s); };
  for (const std::string_view sequence : {"xyz", "yxz"}) {
    // Three times as fast as usual, so that angles grow large.
    const NamedRecording run = rewritten(
        rigid_body::recorded(1, steep, 1.0, 3.0), {"roll_rad", "pitch_rad", "yaw_rad"},
        [&](const Quat& q) {
          return components(
              angles_of_attitude(sequence, Quat(Eigen::AngleAxisd(1.0, Vec3::UnitX())) * q));
        },
        true);
    const Segments read = observe_segments(run.recording, run.name, {});
    ASSERT_TRUE(read.angles);
    EXPECT_EQ(read.angles->sequence, sequence);
    EXPECT_THAT(read.angles->text, HasSubstr("in the sequence " + std::string(sequence)));
    // As read they agree with the gyro, and nothing is to be repaired.
    Observation seen = read.all.front();
    EXPECT_EQ(repair_conventions({&seen, 1}), "");
  }
}

TEST(ScalarReadings, AnglesInDegreesUnderRadiansAreFoundAndTheUsualSequenceIsLeft) {
  for (const double unit : {1.0, 1.0 / degree_rad}) {
    const NamedRecording run = rewritten(
        rigid_body::recorded(2, dipole_torque, 1.0, 2.0), {"roll_rad", "pitch_rad", "yaw_rad"},
        [&](const Quat& q) { return components(unit * angles_of_attitude("zyx", q)); }, true);
    const Segments read = observe_segments(run.recording, run.name, {});
    ASSERT_TRUE(read.angles);
    EXPECT_EQ(read.angles->sequence, "zyx");
    EXPECT_EQ(read.angles->factor, unit == 1.0 ? 1.0 : degree_rad);
    EXPECT_EQ(read.angles->text.empty(), unit == 1.0);
  }
}

// A gyro whose axes are exchanged is no matter of the angles.
TEST(ScalarReadings, AGyroWithExchangedAxesIsNotTakenForAnotherSequence) {
  NamedRecording run = rewritten(
      rigid_body::recorded(3, dipole_torque, 1.0, 3.0), {"roll_rad", "pitch_rad", "yaw_rad"},
      [](const Quat& q) {
        return components(
            angles_of_attitude("zyx", Quat(Eigen::AngleAxisd(1.0, Vec3::UnitX())) * q));
      },
      true);
  std::swap(run.recording.channels[3].values, run.recording.channels[5].values);
  run.recording.channels[4].values[10] = NAN;
  const Segments read = observe_segments(run.recording, run.name, {});
  ASSERT_TRUE(read.angles);
  EXPECT_EQ(read.angles->text, "");
  Observation seen = read.all.front();
  const Vec3 before = seen.gyro_rad_s[10];
  // A piece that is too short to decide alone is read as the others are.
  const size_t end = seen.blocks(), cut = end - 12;
  std::vector<Observation> pieces = {seen.part(0, cut), seen.part(cut, end)};
  EXPECT_EQ(repair_conventions({&pieces[1], 1}), "");
  EXPECT_THAT(repair_conventions(pieces), HasSubstr("+z, +y, +x"));
  EXPECT_EQ(pieces[1].gyro_rad_s[5].x(), seen.gyro_rad_s[cut + 5].z());
  EXPECT_THAT(repair_conventions({&seen, 1}), HasSubstr("the gyro's axes x, y, z are +z, +y, +x"));
  // The one axis that was not read makes nothing of the others.
  EXPECT_EQ(seen.gyro_rows[10], Vec3(1, 0, 1));
  EXPECT_EQ(seen.gyro_rad_s[10].x(), before.z());
  EXPECT_EQ(seen.gyro_rad_s[10].z(), before.x());
}

NamedRecording by_tilt_and_heading(unsigned seed, const rigid_body::Extra& torque) {
  return rewritten(
      rigid_body::recorded(seed, torque), {"tilt_rad", "yaw_rad"},
      [](const Quat& q) {
        return std::vector<double>{matrix_tilt(q), matrix_yaw(q)};
      },
      false);
}

TEST(ScalarReadings, ADipoleIsNamedByTiltAndHeadingAlone) {
  const Diagnosis d =
      diagnose(rigid_body::nominal_model(),
               {by_tilt_and_heading(1, dipole_torque), by_tilt_and_heading(2, dipole_torque)}, {});
  EXPECT_EQ(d.verdict, Verdict::missing_physics) << d.sentence;
  ASSERT_THAT(kinds_of(d), ElementsAre("magnetic_dipole")) << d.sentence;
  const FittedParameter& dipole = d.effects.front().parameters.front();
  // The mirror image of the motion reads the same: its dipole has the other sign about z.
  const Vec3 truth(0.03, -0.02, 0.04);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(std::abs(dipole.value[k]), std::abs(truth[static_cast<Eigen::Index>(k)]),
                5.0 * dipole.sigma[k]);
  }
  EXPECT_THAT(d.warnings, Contains(HasSubstr("mirror image")));
  std::vector<std::string> channels;
  for (const auto& channel : d.where.channels) channels.push_back(channel.name);
  EXPECT_THAT(channels, UnorderedElementsAre("tilt_arcsec", "yaw_arcsec"));
}

TEST(ScalarReadings, NothingIsNamedByTiltAndHeadingWhereNothingIsMissing) {
  const auto nothing = [](const rigid_body::State&) -> Vec3 { return Vec3::Zero(); };
  const Diagnosis d = diagnose(rigid_body::nominal_model(), {by_tilt_and_heading(4, nothing)}, {});
  EXPECT_EQ(d.verdict, Verdict::consistent) << d.sentence;
  EXPECT_LT(d.chi2_per_sample_after, 1.3);
}

// A body with three different moments that turns freely, with a drag by the square of the rate or
// without: Euler's equations.
struct FreeBody {
  Vec3 inertia{1.0, 0.8, 0.5};
  double drag_N_m_s2 = 0.0;

  Vec3 acceleration(const Vec3& w) const {
    const Vec3 momentum = inertia.cwiseProduct(w);
    const Vec3 torque = -drag_N_m_s2 * w.norm() * w - w.cross(momentum);
    return torque.cwiseQuotient(inertia);
  }
  // By the classical Runge–Kutta method.
  Vec3 after(const Vec3& w, double h) const {
    const Vec3 a = acceleration(w), b = acceleration(w + 0.5 * h * a),
               c = acceleration(w + 0.5 * h * b), e = acceleration(w + h * c);
    return w + h / 6.0 * (a + 2.0 * b + 2.0 * c + e);
  }
};

// The length of its rate.
Recording length_of_rate(double drag_N_m_s2, uint64_t seed) {
  constexpr double interval_s = 0.02, noise_rad_s = 2e-3;
  constexpr int rows = 900, steps = 4;
  const FreeBody body{.drag_N_m_s2 = drag_N_m_s2};
  Noise noise(seed, noise_rad_s);
  Channel length{"rate_magnitude_rad_s", {}};
  Vec3 w(2.0, 3.0, 0.7);
  for (int row = 0; row < rows; ++row) {
    length.values.push_back(w.norm() + noise());
    for (int k = 0; k < steps; ++k) w = body.after(w, interval_s / steps);
  }
  return recording_of(interval_s, {length});
}

NominalModel free_body() {
  return machine(
      "[platform]\ntopology = \"free\"\n"
      "inertia_kg_m2 = [[1, 0, 0], [0, 0.8, 0], [0, 0, 0.5]]\n"
      "[sensors.gyro]\nnoise_rad_s = 0.002\n");
}

TEST(ScalarReadings, TheLengthOfARateNamesTheDragOfABody) {
  const Diagnosis none = diagnose(free_body(), {{"none.csv", length_of_rate(0.0, 1)}}, {});
  EXPECT_EQ(none.verdict, Verdict::consistent) << none.sentence;
  EXPECT_LT(none.chi2_per_sample_before, 1.3);
  const Diagnosis drag = diagnose(free_body(), {{"drag.csv", length_of_rate(0.005, 2)}}, {});
  ASSERT_THAT(kinds_of(drag), Contains("air_pressure_drag")) << drag.sentence;
  ASSERT_TRUE(drag.holdout);
  EXPECT_LT(drag.holdout->chi2_per_sample_after, 2.0);
}

// An instrument that the experiment lacks is not compared, with a note.
TEST(ScalarReadings, AnUndeclaredAccelerometerIsNotCompared) {
  NamedRecording run = rigid_body::recorded(5, dipole_torque);
  for (const char* name : {"accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"}) {
    run.recording.channels.push_back({name, std::vector<double>(run.recording.rows(), 3.0)});
  }
  const Diagnosis d = diagnose(rigid_body::nominal_model(), {run}, {});
  EXPECT_THAT(kinds_of(d), ElementsAre("magnetic_dipole")) << d.sentence;
  EXPECT_THAT(d.warnings, Contains(HasSubstr("accel_x_m_s2, accel_y_m_s2, accel_z_m_s2 are not "
                                             "compared")));
}

// A thrown body with a gyro and an accelerometer 10 cm from its centre of mass: f = ω' × r + ω × (ω
// × r), without gravity. At another place it would not read that.
TEST(ScalarReadings, AnAccelerometerOfAFreeBodyDependsOnItsPosition) {
  constexpr double interval_s = 0.01;
  constexpr int rows = 600;
  const Vec3 place_m(0.1, -0.05, 0.02);
  const FreeBody body;
  Noise normal(8);
  std::vector<Channel> channels;
  for (const char* name : {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2",
                           "accel_y_m_s2", "accel_z_m_s2"}) {
    channels.push_back({name, {}});
  }
  Vec3 w(2.0, 3.0, 0.7);
  for (int row = 0; row < rows; ++row) {
    const Vec3 force = body.acceleration(w).cross(place_m) + w.cross(w.cross(place_m));
    for (int k = 0; k < 3; ++k) {
      channels[static_cast<size_t>(k)].values.push_back(w[k] + 2e-3 * normal());
      channels[static_cast<size_t>(3 + k)].values.push_back(force[k] + 5e-3 * normal());
    }
    w = body.after(w, interval_s);
  }
  NominalModel nominal = free_body();
  nominal.sensors.accelerometer.emplace().noise_m_s2 = 5e-3;
  nominal.sensors.accelerometer->position_m = place_m;
  const Diagnosis right = diagnosed(nominal, interval_s, channels);
  EXPECT_EQ(right.verdict, Verdict::consistent) << right.sentence;
  EXPECT_NEAR(right.chi2_per_sample_after, 1.0, 0.15);
  nominal.sensors.accelerometer->position_m = Vec3(0.1, -0.05, 0.05);
  const Diagnosis wrong = diagnosed(nominal, interval_s, channels);
  EXPECT_NE(wrong.verdict, Verdict::consistent);
  EXPECT_GT(wrong.chi2_per_sample_before, 20.0);
}

}  // namespace
}  // namespace photorque
