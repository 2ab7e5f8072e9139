// The noise of the instruments is found from the readings, under any torque.
#include <gtest/gtest.h>

#include "attitude/estimation/fit.h"
#include "attitude/observation/noise_search.h"
#include "attitude/observation/prediction.h"
#include "attitude/propagation/run.h"
#include "core/errors.h"
#include "diagnosis/attitude/recorded_data.h"
#include "tests/diagnosis/noisy_recording.h"

namespace photorque {
namespace {

using namespace rigid_body;

Observation observed(unsigned seed, const Session& session, const Extra& extra = nothing_more) {
  return observe(recorded_with(seed, session, extra).recording, "run");
}

NoiseFindings found_in(const Observation& seen) {
  const Fit fit = fit_nominal(nominal_model(), {seen});
  try {
    return find_noise({seen}, residuals_of(fit, {seen}), {});
  } catch (const NumericalError&) {
    return find_noise({seen}, {}, {});
  }
}

// A torque that turns the platform up to 1.2 rad/s, 1e8 of χ² per sample.
Vec3 strong(const State& s) {
  return s.lab_from_body.conjugate() * Vec3(0.0, 0.0, 1e-3);
}

// Means of an AR(1) process, summed term by term.
TEST(Whitening, MeansOfCorrelatedReadingsHaveTheirVarianceAndCovariance) {
  for (const int n : {1, 2, 7, 40}) {
    for (const double steps : {0.01, 0.3, 0.5}) {
      double variance = 0.0, next = 0.0;
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          variance += std::exp(-steps * std::abs(i - j)) / (n * n);
          next += std::exp(-steps * (j + n - i)) / (n * n);
        }
      }
      const MeanOfCorrelated mean = mean_of_correlated(n, steps);
      EXPECT_NEAR(mean.variance, variance, 1e-9 * variance) << n << " " << steps;
      EXPECT_NEAR(mean.reach * mean.reach * std::exp(-steps * n), next, 1e-9 * next) << n;
    }
  }
}

// Blocks of any size with gaps, whitened, against the covariance that their means have: the
// whitened covariance is the identity.
TEST(Whitening, IsExactForMeansGapsAndAWhitePart) {
  Observation seen;
  const double interval_s = 0.1, time_s = 0.7, coloured = 0.6, level = 3.0;
  const std::vector<double> starts_s = {0.0, 0.1, 0.2, 0.7, 1.2, 1.7, 6.0, 6.5, 7.0, 7.5};
  const std::vector<int> counts = {1, 1, 5, 5, 5, 1, 5, 5, 5, 5};
  const auto blocks = static_cast<Eigen::Index>(counts.size());
  std::vector<std::vector<double>> readings_s;
  for (size_t b = 0; b < counts.size(); ++b) {
    readings_s.emplace_back();
    for (int i = 0; i < counts[b]; ++i) readings_s.back().push_back(starts_s[b] + interval_s * i);
    seen.time_s.push_back(0.5 * (readings_s.back().front() + readings_s.back().back()));
    seen.attitude_rows.push_back(0.0);
    seen.gyro_rows.push_back(Vec3::Constant(counts[b]));
  }
  seen.noise.set(4, {level, coloured, time_s});
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(blocks, blocks);
  for (Eigen::Index a = 0; a < blocks; ++a) {
    for (Eigen::Index b = 0; b < blocks; ++b) {
      const auto &as_s = readings_s[static_cast<size_t>(a)],
                 &bs_s = readings_s[static_cast<size_t>(b)];
      for (const double s : as_s) {
        for (const double t : bs_s) {
          const double same = s == t ? 1.0 - coloured : 0.0;
          covariance(a, b) += level * level *
                              (same + coloured * std::exp(-std::abs(s - t) / time_s)) /
                              static_cast<double>(as_s.size() * bs_s.size());
        }
      }
    }
  }
  ASSERT_NEAR(reading_interval_s(seen, 4), interval_s, 1e-12);
  // Row by row what becomes of each block alone: the matrix of the whitening.
  Whitening whitening(seen, 4, blocks);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Identity(blocks, blocks);
  for (Eigen::Index b = 0; b < blocks; ++b) {
    whitening.apply(seen.time_s[static_cast<size_t>(b)], counts[static_cast<size_t>(b)],
                    rows.row(b));
  }
  const Eigen::MatrixXd white = rows * covariance * rows.transpose();
  EXPECT_LT((white - Eigen::MatrixXd::Identity(blocks, blocks)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(NoiseSearch, LeavesNoiseThatIsAsStatedAlone) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    for (const bool gyro : {true, false}) {
      Session session;
      session.has_gyro = gyro;
      for (const FoundNoise& c : found_in(observed(seed, session)).channel) {
        EXPECT_FALSE(c.level_found || c.colour_found) << seed << " " << gyro;
      }
    }
  }
}

// Within a fifth, and within four standard errors, under any torque.
TEST(NoiseSearch, MeasuresTheCorrelationTime) {
  for (const double time_s : {0.3, 1.0, 4.0}) {
    for (const bool acts : {false, true}) {
      Session session;
      session.camera.time_s = time_s;
      const Extra cogging = [](const State& s) {
        const Vec3 forward = s.lab_from_body * Vec3::UnitX();
        return Vec3(0.0, 0.0, 1e-4 * std::sin(3.0 * std::atan2(forward.y(), forward.x())));
      };
      const NoiseFindings found = found_in(observed(3, session, acts ? cogging : nothing_more));
      for (size_t k = 0; k < 3; ++k) {
        const FoundNoise& c = found.channel[k];
        EXPECT_TRUE(c.colour_found) << time_s << " " << acts << " " << k;
        EXPECT_FALSE(c.level_found) << c.noise.level;
        EXPECT_NEAR(c.noise.time_s, time_s, 0.2 * time_s);
        EXPECT_NEAR(c.noise.time_s, time_s, 4.0 * c.time_sigma_s);
      }
    }
  }
}

// A gyro that rounds correlated noise to coarse steps: rounding adds a white part of step²/12
// (Widrow and Kollár, Quantization Noise, 2008, chapter 4), and the time is that of the rest.
TEST(NoiseSearch, CorrelatedNoiseAndRoundingAreDistinguished) {
  const double time_s = 0.8, level = 0.7, step = 1.2;
  Session session;
  session.gyro = {.level = level, .time_s = time_s};
  session.interval_s = 0.05;
  NamedRecording recorded = recorded_with(5, session, nothing_more);
  const double step_rad_s = step * observed(5, session).noise.of(3).level;
  for (Channel& channel : recorded.recording.channels) {
    if (channel.name.rfind("gyro_", 0) != 0) continue;
    for (double& reading : channel.values) {
      reading = step_rad_s * std::round(reading / step_rad_s);
    }
  }
  const NoiseFindings found = found_in(observe(recorded.recording, "run"));
  const double white = step * step / 12.0, variance = level * level + white;
  for (size_t k = 3; k < 6; ++k) {
    const FoundNoise& c = found.channel[k];
    ASSERT_TRUE(c.colour_found) << k;
    EXPECT_NEAR(c.noise.coloured, level * level / variance, 0.08);
    EXPECT_NEAR(std::log(c.noise.time_s / time_s), 0.0, 0.3);
  }
}

TEST(NoiseSearch, MeasuresALevelThatIsNotAsStated) {
  for (const double level : {0.6, 2.0}) {
    Session session;
    session.camera.level = session.gyro.level = level;
    const Observation seen = observed(4, session);
    const NoiseFindings found = found_in(seen);
    for (int k = 0; k < 6; ++k) {
      const FoundNoise& c = found.channel[static_cast<size_t>(k)];
      EXPECT_TRUE(c.level_found) << k;
      EXPECT_FALSE(c.colour_found) << k;
      const double ratio = c.noise.level / seen.noise.of(k).level;
      EXPECT_NEAR(std::log(ratio / level), 0.0, 4.0 * c.level_sigma) << k;
      EXPECT_LT(c.level_sigma, 0.06);
    }
  }
}

// A vibration of 1.4 Hz that the nominal model lacks appears as correlated gyro noise. About the
// model with the vibration, the noise is as stated.
TEST(NoiseSearch, ReplacesNoiseThatContainsAnEffect) {
  const Vec3 amplitude_N_m(3e-4, 2e-4, 1e-4);
  const double frequency_Hz = 1.4;
  const auto vibration = [&](const State& s) -> Vec3 {
    return amplitude_N_m * std::sin(2.0 * pi * frequency_Hz * s.time_s);
  };
  Session session;
  session.interval_s = 0.05;
  RecordedData data;
  data.train = {observed(1, session, vibration)};
  data.held = {observed(2, session, vibration)};
  const NoiseLevels stated = data.train.front().noise;
  settle(nominal_model(), {}, data);
  ASSERT_TRUE(data.noise_before);
  ASSERT_GT(data.train.front().noise.of(3).coloured, 0.0);
  NominalModel vibrating = nominal_model();
  vibrating.model.disturbances.push_back(make_disturbance_of(
      "periodic_torque",
      {{"torque_N_m", {amplitude_N_m.x(), amplitude_N_m.y(), amplitude_N_m.z()}},
       {"frequency_Hz", {frequency_Hz}}},
      vibrating.context()));
  EXPECT_TRUE(estimate_noise_again(fit_nominal(vibrating, data.train), {}, data));
  EXPECT_TRUE(data.instruments.empty());
  for (const auto* runs : {&data.train, &data.held}) {
    for (int k = 0; k < 6; ++k) {
      EXPECT_EQ(runs->front().noise.of(k).level, stated.of(k).level);
      EXPECT_EQ(runs->front().noise.of(k).coloured, 0.0);
    }
  }
}

// A missing effect is not noise, however strong.
TEST(NoiseSearch, TakesNoPhysicsForNoise) {
  Session pulsed;
  pulsed.pulse_N_m = 1e-3;
  pulsed.pulse_gain = 1.05;
  for (const NoiseFindings& found :
       {found_in(observed(1, pulsed)), found_in(observed(1, {}, strong))}) {
    for (const FoundNoise& c : found.channel) EXPECT_FALSE(c.level_found || c.colour_found);
  }
}

}  // namespace
}  // namespace photorque
