// `balance`: the offset of the centre of mass from a recording, and the moves of the balancing
// masses that bring it to the centre of rotation.
//
// The first step is a linear batch estimate from the change of momentum over short intervals,
//   I Δω + ∫ ω × I ω dt = m r × ∫ g dt + ∫ command dt − c ∫ ω dt
// (R. Kim, B. Agrawal, J. Guid. Control Dyn. 32 (2009) 1513, in integrated form). It needs no
// initial value. The second step fits the whole trajectory and uses all of the data.
#pragma once

#include "attitude/disturbances/mass/moving_masses.h"
#include "attitude/estimation/fit.h"
#include "core/product.h"
#include "core/settings/keys.h"

namespace photorque {

// Least-squares offset of the centre of mass [m], body axes, from the changes of momentum over
// intervals of `interval_s`. InputError if the recording has too few complete rows.
Vec3 offset_from_momentum_m(const Platform& platform, const Vec3& gravity_lab_m_s2,
                            const Recording& recording, double interval_s = 2.0);

struct BalanceRun {
  AttitudeModel model;
  Sensors sensors;
  std::vector<MovingMass> masses;
  Recording recording;
};
// Reads [platform], [environment], [[disturbance]], [sensors], [recording] and [balance] (the keys
// of read_moving_masses()) of an experiment, and a recording.
BalanceRun read_balance(const Settings& root, const std::filesystem::path& recording);

struct BalanceResult {
  Vec3 offset_body_m = Vec3::Zero();
  // Standard errors. If the residual exceeds the noise, it counts as noise with its level and
  // correlation time, and the largest deviation of six parts of the recording from the whole is
  // added. Infinite along an axis that the recording does not determine, such as the vertical of a
  // platform that stays level.
  Vec3 sigma_m = Vec3::Zero();
  BalanceCommand command;     // of the masses, and the remaining offset
  double resolution_m = 0.0;  // of the coarsest axis, half a step (eq. 1)
  // χ² per sample of the fit with the noise of the instruments, and its excess over one in standard
  // errors. Above `noticed_sigma` the model lacks an effect, which may bias the offset.
  double chi2_per_sample = 0.0, excess_sigma = 0.0;
  static constexpr double noticed_sigma = 6.0;
  bool exceeds_noise() const { return excess_sigma > noticed_sigma; }
  std::string warning() const;  // as printed; empty if the residual is noise
  size_t segments = 1;          // number of segments between gaps of the recording
  Fit fit;
  // Residuals of the camera's attitudes about lab axes, at these times.
  std::vector<double> residual_time_s;
  std::vector<Vec3> camera_residual_rad;
};
BalanceResult balance(const BalanceRun& run);

// Tables "balance" (by axis, with the paper's 1.79e-7 m) and "moving_masses", a plot of the
// residuals, and headline figures.
Product balance_product(const BalanceRun& run, const BalanceResult& result);

// The keys of [balance].
Key balance_table();

}  // namespace photorque
