#include "tools/proof/strength.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "tools/proof/information.h"

namespace photorque::injected {
namespace {

constexpr double within_noise = 12.0;  // of chi²
constexpr double linear_gain = 5e4;    // up to which the strength is fitted to its own motion

// Kinds whose all strengths, and the effects themselves where their numbers enter otherwise, may
// take up what effect `index` does.
std::vector<Eigen::MatrixXd> others_of(const InjectedInformation& information,
                                       const InjectedCase& c, const std::vector<size_t>& without,
                                       const std::vector<Eigen::VectorXd>& changes) {
  std::vector<Eigen::MatrixXd> others;
  for (size_t i = 0; i < c.world.effects.size(); ++i) {
    if (std::ranges::find(without, i) != without.end()) continue;
    Eigen::MatrixXd columns = information.columns_of(c.world.effects[i].kind);
    if (columns.cols() == 0) columns = changes[i];
    others.push_back(std::move(columns));
  }
  return others;
}

std::vector<Eigen::VectorXd> changes_of(const InjectedInformation& information,
                                        const InjectedCase& c) {
  std::vector<Eigen::VectorXd> changes;
  for (size_t i = 0; i < c.world.effects.size(); ++i) {
    changes.push_back(information.change_by(i, 1e-3));
  }
  return changes;
}

// Of laws outside the catalogue, against all of it or, which is much faster, not.
std::vector<double> gains_of(const InjectedInformation& information, const InjectedCase& c,
                             const std::vector<Recipe>& recipes,
                             const std::vector<Eigen::VectorXd>& changes, bool against_catalogue) {
  std::vector<double> gains;
  for (size_t i = 0; i < recipes.size(); ++i) {
    auto others = others_of(information, c, {i}, changes);
    if (recipes[i].outside && against_catalogue) {
      for (const std::string& kind : information.competitors()) {
        others.push_back(information.columns_of(kind));
      }
    }
    gains.push_back(information.gain(changes[i], others));
  }
  return gains;
}

// Kinds that could pass for one of the effects, or for two of them at once: what they leave is
// within the noise. `factors`: by how much each effect is to be stronger yet.
void add_doubles(const InjectedInformation& information, const InjectedCase& c,
                 const std::vector<Eigen::VectorXd>& changes, const std::vector<double>& factors,
                 Strengths& strengths) {
  std::vector<std::string> names;
  for (const InjectedEffect& effect : c.world.effects) {
    if (!is_outside_catalogue(effect.kind)) names.push_back(effect.kind);
  }
  const auto try_swap = [&](const std::vector<size_t>& out) {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(changes[0].size());
    for (const size_t i : out) change += factors[i] * changes[i];
    auto others = others_of(information, c, out, changes);
    for (const std::string& kind : information.competitors()) {
      if (std::ranges::find(names, kind) != names.end()) continue;
      others.push_back(information.columns_of(kind));
      const double left = information.gain(change, others);
      others.pop_back();
      if (left >= within_noise) continue;
      std::vector<std::string> set = {kind};
      for (size_t i = 0; i < names.size(); ++i) {
        if (std::ranges::find(out, i) == out.end()) set.push_back(names[i]);
      }
      strengths.doubles.push_back(set);
    }
  };
  // Laws outside of the catalogue stand behind the kinds.
  for (size_t i = 0; i < names.size(); ++i) {
    try_swap({i});
    for (size_t k = i + 1; k < names.size(); ++k) try_swap({i, k});
  }
}

bool is_body(const std::array<Triple, 3>& inertia_kg_m2) {
  Eigen::Matrix3d tensor;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      tensor(i, k) = inertia_kg_m2[static_cast<size_t>(i)][static_cast<size_t>(k)];
    }
  }
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor, Eigen::EigenvaluesOnly).eigenvalues();
  return moments[0] > 0.0 && moments[2] <= moments[0] + moments[1];
}

// By how much effect `index` can be made stronger than it is where chi² is to gain `by` times more,
// taken back until the motion stays physical.
double extrapolation(const InjectedCase& c, size_t index, const Recipe& recipe, double by,
                     double loosened) {
  if (c.world.effects[index].parameters.empty() || !std::isfinite(by)) return 1.0;
  // An angle or a share has a limit of its own; a torque may be ten times what is common.
  const double room = recipe.injection.max_factor >= 30.0 ? 10.0 : 1.0;
  double factor =
      std::min(std::sqrt(by), std::max(1.0, room * recipe.injection.max_factor * loosened));
  for (; factor > 1.05; factor = 1.0 + 0.5 * (factor - 1.0)) {
    InjectedCase stronger = c;
    scale_effect(stronger.world.effects[index], factor);
    try {
      if (stays_physical(stronger)) return factor;
    } catch (const NumericalError&) {
      continue;  // it diverges
    }
  }
  return 1.0;
}

}  // namespace

double Strengths::least() const {
  return gains.empty() ? 0.0 : *std::ranges::min_element(gains);
}

bool stays_physical(const InjectedCase& c) {
  constexpr double max_tilt_rad = 60.0 * pi / 180.0, max_rate_rad_s = 4.0;
  // Between two readings of the camera, so that no turn is missed.
  const double max_turn_rad = 0.8;
  if (!is_body(injected_inertia_kg_m2(c.world))) return false;
  for (const InjectedRun& run : c.runs) {
    std::vector<double> times_s;
    for (double t = 0.0; t < run.duration_s; t += 0.5) times_s.push_back(t);
    const auto moments =
        injected_motion(c.world, run.commands, run.start, injected_start_s(c.world), times_s, 0.05);
    for (const InjectedContext& m : moments) {
      const double rate = length(m.rate_rad_s);
      const double up = to_body(m.attitude, {0, 0, 1})[2];
      if (rate > max_rate_rad_s) return false;
      if (rate * c.sensors.camera_every / c.sensors.rate_Hz > max_turn_rad) return false;
      if (c.topology != "free" && up < std::cos(max_tilt_rad)) return false;
    }
  }
  return true;
}

Strengths fit_strengths(InjectedCase& c, const std::vector<Recipe>& recipes,
                        const std::vector<double>& wanted, double loosened) {
  Strengths strengths;
  if (recipes.empty()) return strengths;
  std::vector<double> reached(recipes.size(), 1.0);  // times what was drawn
  constexpr int rounds = 3;
  std::vector<double> beyond(recipes.size(), 1.0);  // the share that the catalogue leaves
  for (int round = 0;; ++round) {
    const InjectedInformation information(c);
    const auto changes = changes_of(information, c);
    const auto gains = gains_of(information, c, recipes, changes, false);
    // What the catalogue leaves changes little with the strength.
    if (round == 1 || round == rounds) {
      strengths.gains = gains_of(information, c, recipes, changes, true);
      for (size_t i = 0; i < recipes.size(); ++i) beyond[i] = strengths.gains[i] / gains[i];
    }
    std::vector<double> factors(recipes.size(), 1.0);
    double most = 0.0;
    for (size_t i = 0; i < recipes.size(); ++i) {
      if (c.world.effects[i].parameters.empty() || !(gains[i] > 0.0)) continue;
      const double by = std::sqrt(std::min(wanted[i], linear_gain) / (gains[i] * beyond[i]));
      factors[i] = std::clamp(by, 1e-5 / reached[i],
                              recipes[i].injection.max_factor * loosened / reached[i]);
      most = std::max(most, std::abs(factors[i] - 1.0));
    }
    const bool last = round == rounds || (round == 1 && most < 0.1);
    if (last) {
      for (size_t i = 0; i < recipes.size(); ++i) {
        factors[i] = wanted[i] > linear_gain
                         ? extrapolation(c, i, recipes[i], wanted[i] / strengths.gains[i],
                                         loosened / reached[i])
                         : 1.0;
      }
      add_doubles(information, c, changes, factors, strengths);
    }
    for (size_t i = 0; i < recipes.size(); ++i) {
      scale_effect(c.world.effects[i], factors[i]);
      reached[i] *= factors[i];
      if (last) strengths.gains[i] *= factors[i] * factors[i];
    }
    if (last) return strengths;
  }
}

}  // namespace photorque::injected
