#include "tools/proof/information.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/random.h"
#include "tools/proof/recipes.h"

namespace photorque {
namespace {

using namespace injected;

constexpr double arcsecond = pi / 180.0 / 3600.0;

// Kinds whose readings change in proportion to all their numbers, or that have none, those that
// always act first: the order of columns decides the last digits of a gain.
std::vector<Recipe> linear_recipes() {
  std::vector<Recipe> all;
  for (const Recipe& r : recipes()) {
    const bool strong = r.injection.step > 0.0, whole = r.injection.strength.empty();
    if (!r.outside && r.screening.scan == Scan::nothing && (strong || whole)) all.push_back(r);
  }
  std::ranges::stable_sort(all, {}, [](const Recipe& r) {
    if (r.injection.strength.empty()) return 2;
    return r.screening.needs == Requirement::command ? 1 : 0;
  });
  return all;
}

// Kinds that act at one frequency.
bool is_tone(const Recipe& recipe) {
  return recipe.screening.scan == Scan::frequency;
}

// Errors that stay alike over many readings tell as much of what is slow as one reading in so many.
double independent_share(const InjectedNoise& noise, double interval_s) {
  if (noise.time_s == 0.0) return 1.0;
  const double alike = std::exp(-interval_s / noise.time_s);
  return (1.0 - alike) / (1.0 + alike);
}

}  // namespace

InjectedInformation::InjectedInformation(const InjectedCase& injected) : case_(injected) {
  // A reading every 0.7 s or so, at uneven times, stands for those around it.
  const double duration_s = case_.runs[0].duration_s;
  const auto count = static_cast<size_t>(std::clamp(duration_s / 0.7, 200.0, 800.0));
  for (size_t i = 0; i < count; ++i) {
    const double at = static_cast<double>(i) + unit_interval(hash_words(case_.seed, 5, i));
    times_s_.push_back(duration_s * at / static_cast<double>(count));
  }
  // Good to 1e-5 of an effect at up to 0.3 rad/s, and in half the step at 1 rad/s, where the
  // fastest tones are good to a per cent.
  const bool has_tone = std::ranges::any_of(
      case_.world.effects, [](const auto& e) { return e.parameters.contains("frequency_Hz"); });
  const bool is_fast = has_tone || length(case_.runs[0].start.rate_rad_s) > 0.3;
  step_s_ = is_fast && duration_s < 1000.0 ? 0.05 : 0.1;
  const InjectedSensors& sensors = case_.sensors;
  const double rows = duration_s * sensors.rate_Hz, interval_s = 1.0 / sensors.rate_Hz;
  const double each = rows / static_cast<double>(count);
  camera_weight_ =
      std::sqrt(each * independent_share(sensors.camera, interval_s * sensors.camera_every) /
                sensors.camera_every);
  gyro_weight_ =
      sensors.has_gyro ? std::sqrt(each * independent_share(sensors.gyro, interval_s)) : 0.0;
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
    if (priors.gyro_bias_sigma_rad_s > 0.0 && case_.sensors.has_gyro) {
      add(world, start, 1e-6, priors.gyro_bias_sigma_rad_s);
    }
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
  const double latency_s = injected_latency_s(world), start_s = injected_start_s(case_.world);
  const auto& commands = case_.runs[0].commands;
  const auto moments = injected_motion(world, commands, start, start_s, times_s_, step_s_);
  Sampled sampled;
  for (const InjectedContext& moment : moments) {
    sampled.gyro_rad_s.push_back(moment.gyro_rad_s);
    sampled.camera.push_back(moment.camera);
  }
  if (latency_s == 0.0) return sampled;
  std::vector<double> seen_s = times_s_;
  for (double& t : seen_s) t = std::max(start_s, t - latency_s);
  const auto seen = injected_motion(world, commands, start, start_s, seen_s, step_s_);
  for (size_t i = 0; i < seen.size(); ++i) sampled.camera[i] = seen[i].camera;
  return sampled;
}

Eigen::VectorXd InjectedInformation::difference(const Sampled& sampled) const {
  const InjectedSensors& sensors = case_.sensors;
  Eigen::VectorXd all(static_cast<Eigen::Index>(6 * times_s_.size()));
  for (size_t i = 0; i < times_s_.size(); ++i) {
    const Triple turn = turn_of(product(sampled.camera[i], conjugate(base_.camera[i])));
    const Triple faster = minus(sampled.gyro_rad_s[i], base_.gyro_rad_s[i]);
    for (size_t k = 0; k < 3; ++k) {
      const auto at = static_cast<Eigen::Index>(6 * i + k);
      all[at] = camera_weight_ * turn[k] / (sensors.camera_noise_arcsec[k] * arcsecond);
      all[at + 3] = gyro_weight_ * faster[k] / sensors.gyro_noise_rad_s;
    }
  }
  return all;
}

Eigen::VectorXd InjectedInformation::change_by(size_t index, double fraction) const {
  InjectedWorld world = case_.world;
  InjectedEffect& effect = world.effects[index];
  // What an appendage does is not in proportion to its inertia, which also moves its resonance.
  if (effect.parameters.empty() || !recipe_of(effect.kind).is_proportional()) {
    world.effects.erase(world.effects.begin() + static_cast<ptrdiff_t>(index));
    fraction = 1.0;
  } else {
    scale_effect(effect, 1.0 - fraction);
  }
  return -difference(sample(world, case_.runs[0].start)) / fraction;
}

const Eigen::MatrixXd& InjectedInformation::columns_of(const std::string& kind) const {
  const auto found = columns_.find(kind);
  if (found != columns_.end()) return found->second;
  return columns_.emplace(kind, made_columns_of(kind)).first->second;
}

Eigen::MatrixXd InjectedInformation::made_columns_of(const std::string& kind) const {
  std::vector<Eigen::VectorXd> columns;
  const InjectedStart& start = case_.runs[0].start;
  const auto add = [&](const InjectedEffect& effect, double by) {
    InjectedWorld world = case_.world;
    world.effects.push_back(effect);
    columns.emplace_back(difference(sample(world, start)) / by);
  };
  const Recipe& recipe = recipe_of(kind);
  const std::string& strength = recipe.injection.strength;
  const double by = recipe.injection.step;
  const auto add_tone = [&](const InjectedEffect& acting) {
    for (size_t k = 0; k < 6; ++k) {
      std::vector<double> numbers(3, 0.0);
      numbers[k % 3] = by;
      add({kind,
           {{strength, numbers},
            {"frequency_Hz", acting.parameters.at("frequency_Hz")},
            {"phase", {k < 3 ? 0.0 : 0.5 * pi}}}},
          by);
    }
  };
  for (const Recipe& linear : linear_recipes()) {
    if (linear.kind != kind) continue;
    const size_t size = linear.strengths();
    if (size == 0) add({kind, {}}, 1.0);
    for (size_t k = 0; k < size; ++k) {
      std::vector<double> numbers(size, 0.0);
      numbers[k] = by;
      add({kind, {{strength, numbers}}}, by);
    }
  }
  // A tone is searched at the frequency of the one that acts.
  for (const InjectedEffect& acting : case_.world.effects) {
    if (acting.kind != kind && is_tone(recipe) && is_tone(recipe_of(acting.kind))) add_tone(acting);
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
  const InjectedPriors& priors = case_.priors;
  for (const Recipe& recipe : linear_recipes()) {
    const std::string& kind = recipe.kind;
    // What pulls back jumps where the shortest way back changes side.
    const bool cannot = (recipe.injection.needs_small_turns && turns) ||
                        (recipe.screening.needs == Requirement::command && !commanded) ||
                        // Uncertain priors are nuisances already.
                        (kind == nominal_unbalance && priors.offset_sigma_m[0] > 0.0) ||
                        (kind == nominal_drag && priors.drag_sigma_N_m_s > 0.0) ||
                        (kind == nominal_gyro_bias && priors.gyro_bias_sigma_rad_s > 0.0);
    if (!cannot) kinds.push_back(kind);
  }
  for (const InjectedEffect& acting : case_.world.effects) {
    if (!is_tone(recipe_of(acting.kind))) continue;
    for (const Recipe& other : recipes()) {
      if (is_tone(other) && other.kind != acting.kind) kinds.push_back(other.kind);
    }
  }
  return kinds;
}

}  // namespace photorque
