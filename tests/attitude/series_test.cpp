// Time series, floor spectra and wrench tables: interpolation of tabulated values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "attitude/disturbances/fields/torque_surface.h"
#include "attitude/disturbances/motion/vibration.h"
#include "attitude/environment/time_series.h"
#include "core/constants.h"
#include "core/errors.h"
#include "tests/files.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

Vec3 bounce(double t) {
  return {std::sin(t), std::cos(0.7 * t), t * std::exp(-t)};
}

TimeSeries sampled_wave(double step) {
  std::vector<double> times;
  std::vector<Vec3> values;
  for (double t = 0; t < 6.0 + 0.5 * step; t += step) {
    times.push_back(t);
    values.push_back(bounce(t));
  }
  return TimeSeries(times, values);
}

TEST(TimeSeries, PassesThroughItsSamplesAndConvergesBetweenThem) {
  const TimeSeries coarse = sampled_wave(0.2), fine = sampled_wave(0.1);
  EXPECT_LT((coarse.at(1.2) - bounce(1.2)).norm(), 1e-14);
  const double coarse_error = (coarse.at(3.1) - bounce(3.1)).norm();
  const double fine_error = (fine.at(3.05) - bounce(3.05)).norm();
  EXPECT_LT(coarse_error, 1e-4);
  EXPECT_NEAR(coarse_error / fine_error, 16.0, 2.0);  // fourth order, both at midpoints
}

TEST(TimeSeries, SlopeIsTheDerivative) {
  const TimeSeries series = sampled_wave(0.2);
  for (const double t : {0.05, 1.2, 2.71, 5.99}) {
    for (int k = 0; k < 3; ++k) {
      const double difference = (series.at(t + 1e-5, k)[0] - series.at(t - 1e-5, k)[0]) / 2e-5;
      EXPECT_NEAR(series.at(t, k)[1], difference, 1e-8);
    }
  }
}

TEST(TimeSeries, OutsideHoldsOrIsZero) {
  const TimeSeries held({1, 2}, {Vec3(1, 2, 3), Vec3(4, 5, 6)});
  const TimeSeries zero({1, 2}, {Vec3(1, 2, 3), Vec3(4, 5, 6)}, TimeSeries::Outside::zero);
  EXPECT_EQ(held.at(0.0), Vec3(1, 2, 3));
  EXPECT_EQ(held.at(9.0), Vec3(4, 5, 6));
  EXPECT_EQ(zero.at(9.0), Vec3::Zero());
  EXPECT_LT((zero.at(1.5) - Vec3(2.5, 3.5, 4.5)).norm(), 1e-15);
  EXPECT_EQ(zero.ends_s(), (std::array{1.0, 2.0}));
}

TEST(TimeSeries, RefusesDisorder) {
  EXPECT_THROW(TimeSeries({1, 1}, {Vec3::Zero(), Vec3::Zero()}), NumericalError);
  EXPECT_THROW(TimeSeries({1}, {Vec3::Zero()}), NumericalError);
}

TEST(TimeSeries, ReadsColumnsByName) {
  const auto file =
      test_file("series.csv", "# who made it\nnote_1,a_z,t_s,a_x,a_y\n0,3,0,1,2\n\n0,6,0.5,4,5\n");
  const TimeSeries series =
      read_time_series(file, {"a_x", "a_y", "a_z"}, TimeSeries::Outside::hold);
  EXPECT_LT((series.at(0.25) - Vec3(2.5, 3.5, 4.5)).norm(), 1e-15);
}

TEST(TimeSeries, NamesTheLineThatIsWrong) {
  const auto text = test_file("text.csv", "t_s,a,b,c\n0,1,2,3\n1,x,2,3\n");
  const auto order = test_file("order.csv", "t_s,a,b,c\n0,1,2,3\n0,1,2,3\n");
  const auto message = [](const std::filesystem::path& path) {
    return refusal_of([&] { read_time_series(path, {"a", "b", "c"}, TimeSeries::Outside::hold); });
  };
  EXPECT_THAT(message(text), testing::HasSubstr("text.csv:3"));
  EXPECT_THAT(message(order), testing::HasSubstr("order.csv:3"));
}

const std::vector<SpectrumPoint> floor_spectrum = {{1.0, 1e-8}, {10.0, 4e-8}, {50.0, 0.0}};

// The mean square is the area under the spectrum: trapezoids by hand.
TEST(Vibration, TonesCarryThePowerOfTheSpectrum) {
  const double area = 0.5 * 9 * 5e-8 + 0.5 * 40 * 4e-8;
  const std::vector<VibrationTone> tones = tones_of_spectrum(floor_spectrum, 64, 7);
  double mean_square = 0.0;
  for (const VibrationTone& tone : tones) mean_square += 0.5 * std::pow(tone.amplitude_m_s2, 2);
  EXPECT_NEAR(mean_square / area, 1.0, 1e-12);
  // Mean square of the signal of the x axis over 400 s at 200 Hz.
  double sum = 0;
  constexpr int samples = 80000;
  for (int i = 0; i < samples; ++i) {
    double a = 0;
    for (const VibrationTone& tone : tones) {
      a += tone.amplitude_m_s2 *
           std::sin(2 * pi * tone.frequency_Hz * (i * 0.005) + tone.phase_rad.x());
    }
    sum += a * a;
  }
  EXPECT_NEAR(sum / samples / area, 1.0, 0.03);
}

TEST(Vibration, PowerLiesWhereTheSpectrumHasIt) {
  const std::vector<VibrationTone> tones = tones_of_spectrum(floor_spectrum, 400, 3);
  double below_10 = 0;
  for (const VibrationTone& tone : tones) {
    EXPECT_GE(tone.frequency_Hz, 1.0);
    EXPECT_LE(tone.frequency_Hz, 50.0);
    if (tone.frequency_Hz < 10) below_10 += 0.5 * std::pow(tone.amplitude_m_s2, 2);
  }
  EXPECT_NEAR(below_10 / (0.5 * 9 * 5e-8), 1.0, 0.03);
}

TEST(Vibration, SeedDecidesThePhasesAlone) {
  const auto a = tones_of_spectrum(floor_spectrum, 16, 1),
             b = tones_of_spectrum(floor_spectrum, 16, 1),
             c = tones_of_spectrum(floor_spectrum, 16, 2);
  EXPECT_EQ(a[3].phase_rad, b[3].phase_rad);
  EXPECT_NE(a[3].phase_rad, c[3].phase_rad);
  EXPECT_EQ(a[3].amplitude_m_s2, c[3].amplitude_m_s2);
}

// A smooth torque on the sphere of directions, to be tabulated.
Vec3 smooth_torque(const Vec3& d) {
  return {d.x() * d.y(), d.z() * d.x() + 0.2 * d.y(), 0.3 + d.z() * d.z() * d.x()};
}

WrenchTable tabulated(WrenchTable::Angles kind, double low, double high, double step_deg) {
  std::vector<double> polar, around;
  for (double p = low; p < high + 1e-9; p += step_deg) polar.push_back(p * degree_rad);
  for (double a = -180; a < 180 + 1e-9; a += step_deg) around.push_back(a * degree_rad);
  WrenchTable table = make_wrench_table(kind, polar, around);
  for (size_t a = 0; a < around.size(); ++a) {
    for (size_t p = 0; p < polar.size(); ++p) {
      const double elevation =
          kind == WrenchTable::Angles::tilt_heading ? pi / 2 - polar[p] : polar[p];
      table.torque_body_N_m[table.node(a, p)] =
          smooth_torque(towards_light({elevation, around[a]}));
    }
  }
  return table;
}

TEST(TorqueSurface, IsExactAtNodesAndCloseBetween) {
  const TorqueSurface surface(tabulated(WrenchTable::Angles::azimuth_elevation, -90, 90, 5));
  for (const TableAngles at :
       {TableAngles{0.3, 1.1}, {1.5, -2.0}, {-1.4, 3.1}, {1.5707, 0.4}, {-0.01, -3.12}}) {
    EXPECT_LT((surface.at(at).torque_body_N_m - smooth_torque(towards_light(at))).norm(), 2e-4);
  }
  const TableAngles node{20 * degree_rad, -35 * degree_rad};
  EXPECT_LT((surface.at(node).torque_body_N_m - smooth_torque(towards_light(node))).norm(), 1e-14);
}

TEST(TorqueSurface, SlopesAreDerivativesAlsoNearPolesAndSeam) {
  const TorqueSurface surface(tabulated(WrenchTable::Angles::tilt_heading, 0, 40, 5));
  const double h = 1e-6;
  for (const TableAngles at : {TableAngles{0.3, 1.1}, {0.03, -2.0}, {0.5, 3.13}, {0.69, -3.13}}) {
    const auto value = [&](double p, double a) { return surface.at({p, a}).torque_body_N_m; };
    const Vec3 by_polar =
        (value(at.polar_rad + h, at.around_rad) - value(at.polar_rad - h, at.around_rad)) / (2 * h);
    const Vec3 by_around =
        (value(at.polar_rad, at.around_rad + h) - value(at.polar_rad, at.around_rad - h)) / (2 * h);
    EXPECT_LT((surface.at(at).by_polar - by_polar).norm(), 1e-8);
    EXPECT_LT((surface.at(at).by_around - by_around).norm(), 1e-8);
  }
}

TEST(TorqueSurface, HoldsOneStepBeyondItsEdgeAndNoFurther) {
  const TorqueSurface surface(tabulated(WrenchTable::Angles::tilt_heading, 0, 30, 5));
  const Vec3 edge = surface.at({30 * degree_rad, 0.3}).torque_body_N_m;
  EXPECT_EQ(surface.at({33 * degree_rad, 0.3}).torque_body_N_m, edge);
  EXPECT_THROW(surface.at({36 * degree_rad, 0.3}), NumericalError);
}

TEST(TorqueSurface, AgreesWithTheBilinearTable) {
  const WrenchTable table = tabulated(WrenchTable::Angles::azimuth_elevation, -90, 90, 2);
  const TorqueSurface surface(table);
  for (const TableAngles at : {TableAngles{0.31, 1.11}, {-1.02, 2.9}}) {
    EXPECT_LT((surface.at(at).torque_body_N_m - wrench_at(table, at).torque_N_m).norm(), 1e-3);
  }
}

TEST(WrenchTableFile, ReadsFilesOfTheProgram) {
  const auto file = test_file(
      "wrench.csv",
      "# photorque\nheading_deg,tilt_deg,force_x_N,torque_x_N_m,torque_y_N_m,torque_z_N_m\n"
      "0,0,9,1,2,3\n0,30,9,4,5,6\n180,0,9,7,8,9\n180,30,9,10,11,12\n");
  const WrenchTable table = read_wrench_table(file);
  EXPECT_EQ(table.angles, WrenchTable::Angles::tilt_heading);
  EXPECT_EQ(table.torque_body_N_m[table.node(1, 1)], Vec3(10, 11, 12));
  const auto twice = test_file("twice.csv",
                               "azimuth_deg,elevation_deg,torque_x_N_m,torque_y_N_m,torque_z_N_m\n"
                               "0,0,1,2,3\n0,1,1,2,3\n1,0,1,2,3\n0,0,1,2,3\n");
  EXPECT_THROW(read_wrench_table(twice), InputError);
  const auto hole = test_file(
      "hole.csv",
      "azimuth_deg,elevation_deg,torque_x_N_m,torque_y_N_m,torque_z_N_m\n0,0,1,2,3\n1,1,1,2,3\n");
  EXPECT_THROW(read_wrench_table(hole), InputError);
}

// 40,000 rows along a diagonal have 1.6e9 pairs of angles, whose table would need 150 GB.
TEST(WrenchTableFile, AnglesOfRowsThatAreNotThereTakeNoRoom) {
  std::string text = "azimuth_deg,elevation_deg,torque_x_N_m,torque_y_N_m,torque_z_N_m\n";
  for (int i = 0; i < 40000; ++i) {
    const std::string angle = std::to_string(1e-3 * i);
    text += angle + "," + angle + ",0,0,0\n";
  }
  const auto file = test_file("diagonal.csv", text);
  EXPECT_THROW(read_wrench_table(file), InputError);
}

// Headings of 0 and 360 deg are the same node, so that there is no neighbour for an interpolation.
TEST(WrenchTableFile, AnglesOfASingleNodeAreRefused) {
  const std::string header = "heading_deg,tilt_deg,torque_x_N_m,torque_y_N_m,torque_z_N_m\n";
  for (const char* rows : {"0,0,1,2,3\n0,9,1,2,3\n360,0,1,2,3\n360,9,1,2,3\n",
                           "0,0,1,2,3\n90,0,1,2,3\n180,0,1,2,3\n"}) {
    const auto file = test_file("one.csv", header + rows);
    EXPECT_THROW(read_wrench_table(file), InputError) << rows;
  }
}

}  // namespace
}  // namespace photorque
