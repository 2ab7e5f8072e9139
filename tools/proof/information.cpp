#include "tools/proof/information.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/random.h"
#include "tools/proof/vectors.h"

namespace photorque {
namespace {

using namespace injected;

constexpr double start_s = -0.5;  // see files.cpp
// Good to 1e-5 of an effect at up to 1 rad/s, to a per cent of the fastest tones.
constexpr double step_s = 0.05;
constexpr double arcsecond = pi / 180.0 / 3600.0;

// A small amount of each number of a kind, SI, for differences.
struct Nudge {
  std::string kind, key;
  size_t size;
  double by;
};
const std::vector<Nudge>& nudges() {
  static const std::vector<Nudge> all = {
      {"static_unbalance", "offset_m", 3, 1e-8},
      {"battery_discharge", "shift_m_per_Ah", 3, 1e-8},
      {"elastic_sag", "compliance_s2", 3, 1e-9},
      {"bearing_drag", "coefficient_N_m_s", 1, 1e-8},
      {"turbine_torque", "torque_N_m", 1, 1e-9},
      {"dry_friction", "torque_N_m", 1, 1e-9},
      {"air_friction", "coefficient", 1, 1e-8},
      {"air_pressure_drag", "coefficient_N_m_s2", 1, 1e-7},
      {"room_draft", "torque_lab_N_m", 3, 1e-9},
      {"magnetic_dipole", "dipole_A_m2", 3, 1e-5},
      {"eddy_damping", "coefficient_N_m_s_per_T2", 1, 1.0},
      {"rotor_momentum", "momentum_N_m_s", 3, 1e-7},
      {"tether", "stiffness_N_m_per_rad", 1, 1e-8},
      {"inertia_error", "delta_kg_m2", 6, 1e-6},
      {"gravity_tilt", "tilt_rad", 2, 1e-6},
      {"attitude_latency", "latency_s", 1, 1e-4},
      {"gyro_bias", "bias_rad_s", 3, 1e-6},
      {"gyro_scale", "scale", 3, 1e-5},
      {"gyro_misalignment", "misalignment_rad", 3, 1e-5},
      {"camera_misalignment", "misalignment_rad", 3, 1e-6},
      {"actuator_gain", "gain_error", 1, 1e-4},
      {"gravity_gradient", "", 0, 1.0},
      {"earth_rotation", "", 0, 1.0},
  };
  return all;
}

}  // namespace

InjectedInformation::InjectedInformation(const InjectedCase& injected) : case_(injected) {
  // A reading every 0.7 s or so, at uneven times, stands for those around it.
  const double duration_s = case_.runs[0].duration_s;
  const auto count = static_cast<size_t>(duration_s / 0.7);
  for (size_t i = 0; i < count; ++i) {
    const double at = static_cast<double>(i) + unit_interval(hash_words(case_.seed, 5, i));
    times_s_.push_back(duration_s * at / static_cast<double>(count));
  }
  weight_ = std::sqrt(duration_s * case_.sensors.rate_Hz / static_cast<double>(count));
  base_ = sample(case_.world, case_.runs[0].start);
  add_nuisances();
}

void InjectedInformation::add_nuisances() {
  std::vector<Eigen::VectorXd> columns;
  std::vector<double> prior_sigma;  // of each column; 0: free
  const auto add = [&](const InjectedWorld& world, const InjectedStart& start, double by,
                       double sigma) {
    columns.emplace_back(difference(sample(world, start)) / by);
    prior_sigma.push_back(sigma);
  };
  const InjectedPriors& priors = case_.priors;
  const InjectedStart& start = case_.runs[0].start;
  for (size_t k = 0; k < 3; ++k) {
    Triple turn = {};
    turn[k] = 1e-6;
    InjectedStart turned = start;
    turned.attitude = product(quaternion_of(turn), start.attitude);
    add(case_.world, turned, 1e-6, 0.0);
    InjectedStart faster = start;
    faster.rate_rad_s[k] += 1e-7;
    add(case_.world, faster, 1e-7, 0.0);
    InjectedWorld world = case_.world;
    world.offset_m[k] += 1e-8;
    if (priors.offset_sigma_m[k] > 0.0) add(world, start, 1e-8, priors.offset_sigma_m[k]);
    world = case_.world;
    world.gyro_bias_rad_s[k] += 1e-6;
    if (priors.gyro_bias_sigma_rad_s > 0.0) add(world, start, 1e-6, priors.gyro_bias_sigma_rad_s);
  }
  InjectedWorld world = case_.world;
  world.drag_N_m_s += 1e-8;
  if (priors.drag_sigma_N_m_s > 0.0) add(world, start, 1e-8, priors.drag_sigma_N_m_s);

  const auto n = static_cast<Eigen::Index>(columns.size()), rows = columns[0].size();
  nuisance_ = Eigen::MatrixXd::Zero(rows + n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<size_t>(i);
    nuisance_.col(i).head(rows) = columns[k];
    if (prior_sigma[k] > 0.0) nuisance_(rows + i, i) = 1.0 / prior_sigma[k];
  }
}

InjectedInformation::Sampled InjectedInformation::sample(const InjectedWorld& world,
                                                         const InjectedStart& start) const {
  const double latency_s = injected_latency_s(world);
  const auto& commands = case_.runs[0].commands;
  const auto moments = injected_motion(world, commands, start, start_s, times_s_, step_s);
  Sampled sampled;
  for (const InjectedContext& moment : moments) {
    sampled.gyro_rad_s.push_back(moment.gyro_rad_s);
    sampled.camera.push_back(moment.camera);
  }
  if (latency_s == 0.0) return sampled;
  std::vector<double> seen_s = times_s_;
  for (double& t : seen_s) t = std::max(start_s, t - latency_s);
  const auto seen = injected_motion(world, commands, start, start_s, seen_s, step_s);
  for (size_t i = 0; i < seen.size(); ++i) sampled.camera[i] = seen[i].camera;
  return sampled;
}

Eigen::VectorXd InjectedInformation::difference(const Sampled& sampled) const {
  const InjectedSensors& sensors = case_.sensors;
  const double camera_weight = weight_ / std::sqrt(sensors.camera_every);
  Eigen::VectorXd all(static_cast<Eigen::Index>(6 * times_s_.size()));
  for (size_t i = 0; i < times_s_.size(); ++i) {
    const Triple turn = turn_of(product(sampled.camera[i], conjugate(base_.camera[i])));
    const Triple faster = minus(sampled.gyro_rad_s[i], base_.gyro_rad_s[i]);
    for (size_t k = 0; k < 3; ++k) {
      const auto at = static_cast<Eigen::Index>(6 * i + k);
      all[at] = camera_weight * turn[k] / (sensors.camera_noise_arcsec[k] * arcsecond);
      all[at + 3] = weight_ * faster[k] / sensors.gyro_noise_rad_s;
    }
  }
  return all;
}

Eigen::VectorXd InjectedInformation::change_by(size_t index, double fraction) const {
  InjectedWorld world = case_.world;
  InjectedEffect& effect = world.effects[index];
  // What an appendage does is not in proportion to its inertia, which also moves its resonance.
  if (effect.parameters.empty() || effect.kind == "flexible_mode") {
    world.effects.erase(world.effects.begin() + static_cast<ptrdiff_t>(index));
    fraction = 1.0;
  } else {
    scale_effect(effect, 1.0 - fraction);
  }
  return -difference(sample(world, case_.runs[0].start)) / fraction;
}

Eigen::MatrixXd InjectedInformation::columns_of(const std::string& kind) const {
  std::vector<Eigen::VectorXd> columns;
  const InjectedStart& start = case_.runs[0].start;
  const auto add = [&](const InjectedEffect& effect, double by) {
    InjectedWorld world = case_.world;
    world.effects.push_back(effect);
    columns.emplace_back(difference(sample(world, start)) / by);
  };
  const auto add_tone = [&](const std::string& name, const std::string& key, double by,
                            const InjectedEffect& acting) {
    for (size_t k = 0; k < 6; ++k) {
      std::vector<double> numbers(3, 0.0);
      numbers[k % 3] = by;
      add({name,
           {{key, numbers},
            {"frequency_Hz", acting.parameters.at("frequency_Hz")},
            {"phase", {k < 3 ? 0.0 : 0.5 * pi}}}},
          by);
    }
  };
  for (const Nudge& nudge : nudges()) {
    if (nudge.kind != kind) continue;
    if (nudge.size == 0) add({kind, {}}, 1.0);
    for (size_t k = 0; k < nudge.size; ++k) {
      std::vector<double> numbers(nudge.size, 0.0);
      numbers[k] = nudge.by;
      add({kind, {{nudge.key, numbers}}}, nudge.by);
    }
  }
  // A tone is searched at the frequency of the one that acts.
  for (const InjectedEffect& acting : case_.world.effects) {
    if (kind == "periodic_torque" && acting.kind == "floor_vibration") {
      add_tone(kind, "torque_N_m", 1e-8, acting);
    } else if (kind == "floor_vibration" && acting.kind == "periodic_torque") {
      add_tone(kind, "acceleration_m_s2", 1e-4, acting);
    }
  }
  Eigen::MatrixXd matrix(6 * static_cast<Eigen::Index>(times_s_.size()),
                         static_cast<Eigen::Index>(columns.size()));
  for (size_t i = 0; i < columns.size(); ++i) matrix.col(static_cast<Eigen::Index>(i)) = columns[i];
  return matrix;
}

double InjectedInformation::gain(const Eigen::VectorXd& change,
                                 const std::vector<Eigen::MatrixXd>& others) const {
  Eigen::MatrixXd all = nuisance_;
  for (const Eigen::MatrixXd& columns : others) {
    const Eigen::Index at = all.cols();
    all.conservativeResize(Eigen::NoChange, at + columns.cols());
    all.rightCols(columns.cols()).setZero();
    all.block(0, at, columns.rows(), columns.cols()) = columns;
  }
  // Columns of one length: the numbers behind them have different units.
  for (Eigen::Index i = 0; i < all.cols(); ++i) {
    const double size = all.col(i).norm();
    if (size > 0.0) all.col(i) /= size;
  }
  Eigen::VectorXd left = Eigen::VectorXd::Zero(all.rows());
  left.head(change.size()) = change;
  const Eigen::VectorXd fraction = all.colPivHouseholderQr().solve(left);
  return (left - all * fraction).squaredNorm();
}

std::vector<std::string> InjectedInformation::competitors() const {
  bool turns = false, commanded = false;
  for (const auto& q : base_.camera) turns = turns || length(turn_of(q)) > 3.0;
  for (const InjectedCommand& c : case_.runs[0].commands) {
    commanded = commanded || length(c.torque_N_m) > 0.0;
  }
  std::vector<std::string> kinds;
  for (const Nudge& nudge : nudges()) {
    const std::string& kind = nudge.kind;
    const InjectedPriors& priors = case_.priors;
    // A tether jumps where the shortest way back changes side.
    const bool cannot = (kind == "tether" && turns) || (kind == "actuator_gain" && !commanded) ||
                        // Uncertain priors are nuisances already.
                        (kind == "static_unbalance" && priors.offset_sigma_m[0] > 0.0) ||
                        (kind == "bearing_drag" && priors.drag_sigma_N_m_s > 0.0) ||
                        (kind == "gyro_bias" && priors.gyro_bias_sigma_rad_s > 0.0);
    if (!cannot) kinds.push_back(kind);
  }
  for (const InjectedEffect& acting : case_.world.effects) {
    if (acting.kind == "floor_vibration") kinds.emplace_back("periodic_torque");
    if (acting.kind == "periodic_torque") kinds.emplace_back("floor_vibration");
  }
  return kinds;
}

}  // namespace photorque
