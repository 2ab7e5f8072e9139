#include "diagnosis/attitude/answer.h"

#include <algorithm>
#include <cmath>

#include "attitude/estimation/fit.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/linear.h"

namespace photorque {
namespace {

// Knots of the finest table: their minimum distance and maximum number (each costs three
// parameters).
constexpr double knot_distance_s = 6.5;
constexpr size_t most_knots = 64;
constexpr double typical_torque_N_m = 5e-6;
constexpr int highest_order = 9;  // maximum order of a periodic torque

std::vector<double> even_knots(double duration_s, size_t count) {
  std::vector<double> at;
  for (size_t i = 0; i < count; ++i) {
    at.push_back(duration_s * static_cast<double>(i) / static_cast<double>(count - 1));
  }
  return at;
}

EmpiricalLaw law_in_time(const std::string& description, MotionFunction function) {
  function.of = MotionVariable::time;
  EmpiricalLaw law;
  law.variable = name_of(MotionVariable::time);
  law.description = description;
  law.shape = {{TorqueAxes::body}, {std::move(function)}};
  law.disturbance = empirical_torque(law.shape);
  law.scale = typical_torque_N_m;
  return law;
}

EmpiricalLaw table_over(const std::vector<double>& knots_s) {
  return law_in_time("a smooth function", {.form = FunctionForm::table,
                                           .table = SmoothTable(knots_s),
                                           .range = {{knots_s.front(), knots_s.back()}}});
}

// States of the first run at some instants, as predicted by the trial.
std::vector<PlatformState> states_at(const Trial& trial, const std::vector<Observation>& runs,
                                     const std::vector<double>& times_s) {
  const Dynamics dynamics(trial.fit.best.model_of(0, runs.front()));
  const PlatformState& start = trial.fit.best.runs.front().initial;
  std::vector<double> later_s;
  for (const double t_s : times_s) later_s.push_back(std::max(t_s, start.time_s));
  return propagate(dynamics, start, later_s, {.tolerance = 1e-7}).states;
}

// The trial's model of the first run with one disturbance alone.
AttitudeModel model_with(const Trial& trial, const std::vector<Observation>& runs,
                         const Disturbance& alone) {
  AttitudeModel model = trial.fit.best.model_of(0, runs.front());
  model.disturbances = {alone};
  return model;
}

// Least-squares fit of a law's coefficients to known torques along a motion.
struct Regression {
  Disturbance start;
  double left = 0.0;  // residual sum of squares over the degrees of freedom
};
Regression regressed(AttitudeModel model, size_t first_coefficient,
                     const std::vector<PlatformState>& states, const Eigen::VectorXd& torques) {
  Parameters& parameters = model.disturbances.front().parameters;
  const auto count = static_cast<Eigen::Index>(parameters.size() - first_coefficient);
  Eigen::MatrixXd terms(torques.size(), count);
  for (Eigen::Index c = 0; c < count; ++c) {
    Parameter& coefficient = parameters[first_coefficient + static_cast<size_t>(c)];
    coefficient.value = 1.0;
    for (size_t i = 0; i < states.size(); ++i) {
      terms.block<3, 1>(static_cast<Eigen::Index>(3 * i), c) =
          disturbance_torques_body_N_m(model, states[i]).front();
    }
    coefficient.value = 0.0;
  }
  const Eigen::VectorXd found = terms.completeOrthogonalDecomposition().solve(torques);
  for (Eigen::Index c = 0; c < count; ++c) {
    parameters[first_coefficient + static_cast<size_t>(c)].value = found[c];
  }
  const double freedom = std::max(1.0, static_cast<double>(torques.size() - count));
  return {model.disturbances.front(), (torques - terms * found).squaredNorm() / freedom};
}

// A trial whose law in time is replaced by other laws.
class Refinement {
 public:
  Refinement(const Trial& chosen, size_t which, Candidates& all,
             const std::vector<Observation>& runs)
      : which_(which),
        all_(all),
        runs_(runs),
        worth_chi2_(chosen.fit.chi2 + all.limits.leaders.near_chi2),
        best_(chosen) {}

  Trial exchanged(const Trial& trial, const EmpiricalLaw& law, const Disturbance& start,
                  const std::vector<Observation>& runs) {
    all_.list.push_back(candidate_of(law));
    inference::Options options = until_convergence();
    if (trial.fit.chi2_per_sample() > all_.limits.diverged_chi2_per_sample) {
      options.windows = all_.limits.fitting.diverged_windows;
    }
    return exchange(trial, all_, which_, all_.size() - 1, start, runs, options);
  }

  // Fits tables of increasing resolution to averages, then the finest table to all readings.
  Trial table(double duration_s) {
    const auto finest =
        std::clamp<size_t>(static_cast<size_t>(duration_s / knot_distance_s), 8, most_knots);
    Trial trial = best_;
    for (size_t knots = std::min<size_t>(finest, 16);; knots = std::min(2 * knots, finest)) {
      const std::vector<double> at = even_knots(duration_s, knots);
      const EmpiricalLaw law = table_over(at);
      Disturbance start = law.disturbance;
      const AttitudeModel alone =
          model_with(trial, runs_, trial.fit.best.model.disturbances[trial.disturbances[which_]]);
      const std::vector<PlatformState> states = states_at(trial, runs_, at);
      for (size_t k = 0; k < knots; ++k) {
        const Vec3 torque_N_m = disturbance_torques_body_N_m(alone, states[k]).front();
        for (size_t c = 0; c < 3; ++c) {
          start.parameters[3 * k + c].value = torque_N_m[static_cast<Eigen::Index>(c)];
        }
      }
      const auto averages = averaged_about(trial.fit, runs_, all_.limits.fitting.slow_blocks);
      trial = exchanged(trial, law, start, knots == finest ? runs_ : averages);
      if (knots == finest || !std::isfinite(trial.fit.chi2)) return trial;
    }
  }

  // Starts from the period that explains most of the values of a table.
  Trial periodic(const Trial& table);
  // Tries the simple laws that follow the values of a table best. A fit that started from a nominal
  // motion far from the readings may have missed them.
  void consider_simpler(const Trial& table, size_t laws);

  void consider(const Trial& trial) {
    if (!trial.objection.empty() || !std::isfinite(trial.fit.chi2)) return;
    if (trial.log_evidence > best_.log_evidence) best_ = trial;
  }
  const Trial& best() const { return best_; }

 private:
  // Iterates to convergence as long as the fit can reach the χ² of the previous law.
  inference::Options until_convergence() const {
    return {.max_iterations = 40, .worth_chi2 = worth_chi2_};
  }

  size_t which_;
  Candidates& all_;
  const std::vector<Observation>& runs_;
  double worth_chi2_;
  Trial best_;
};

// Least-squares Fourier series of values over time with a given period.
struct Series {
  double period_s = 0.0, left = 0.0;  // residual sum of squares
  Eigen::MatrixXd coefficients;       // rows: 1, cos, sin, cos 2, sin 2, …
};
Series fitted_series(const std::vector<double>& at_s, const Eigen::MatrixXd& values,
                     double period_s, int orders) {
  Eigen::MatrixXd terms(values.rows(), 2 * orders + 1);
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    terms(i, 0) = 1.0;
    for (int n = 1; n <= orders; ++n) {
      const double angle = 2.0 * pi * n * at_s[static_cast<size_t>(i)] / period_s;
      terms(i, 2 * n - 1) = std::cos(angle);
      terms(i, 2 * n) = std::sin(angle);
    }
  }
  Series series;
  series.period_s = period_s;
  series.coefficients = solve_symmetric(terms.transpose() * terms, terms.transpose() * values);
  series.left = (values - terms * series.coefficients).squaredNorm();
  return series;
}

Trial Refinement::periodic(const Trial& table) {
  const size_t index = table.disturbances[which_];
  // A copy, because candidates are added below.
  const std::vector<double> at_s =
      all_[table.candidates[which_]].law.shape.functions.front().table.knots();
  const Parameters& fitted = table.fit.best.model.disturbances[index].parameters;
  const auto count = static_cast<Eigen::Index>(at_s.size());
  Eigen::MatrixXd values(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      values(i, c) = fitted[static_cast<size_t>(3 * i + c)].value;
    }
  }
  const double span_s = at_s.back(), step_s = at_s[1];
  constexpr int searched_orders = 2;
  Series best;
  for (double f_Hz = 2.5 / span_s; f_Hz < 0.4 / (searched_orders * step_s); f_Hz += 0.05 / span_s) {
    const Series series = fitted_series(at_s, values, 1.0 / f_Hz, searched_orders);
    if (best.period_s == 0.0 || series.left < best.left) best = series;
  }
  if (best.period_s == 0.0) return table;
  std::vector<int> orders;
  for (int n = 0; n <= highest_order; ++n) orders.push_back(n);
  EmpiricalLaw law = law_in_time(
      "periodic", {.form = FunctionForm::harmonics, .orders = orders, .own = best.period_s});
  law.lowest = 0.9 * best.period_s;
  law.highest = 1.1 * best.period_s;
  law.own_scale = 0.03 * best.period_s;
  Disturbance start = law.disturbance;
  for (Eigen::Index t = 0; t < best.coefficients.rows(); ++t) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      start.parameters[static_cast<size_t>(1 + 3 * t + c)].value = best.coefficients(t, c);
    }
  }
  return exchanged(table, law, start, runs_);
}

void Refinement::consider_simpler(const Trial& table, size_t laws) {
  constexpr size_t most = 3;
  const Disturbance& fitted = table.fit.best.model.disturbances[table.disturbances[which_]];
  const std::vector<double>& knots_s =
      all_[table.candidates[which_]].law.shape.functions.front().table.knots();
  // The ends of a table are poorly determined.
  const std::vector<double> at_s(knots_s.begin() + 1, knots_s.end() - 1);
  const std::vector<PlatformState> states = states_at(table, runs_, at_s);
  const AttitudeModel known = model_with(table, runs_, fitted);
  Eigen::VectorXd torques(3 * static_cast<Eigen::Index>(states.size()));
  for (size_t i = 0; i < states.size(); ++i) {
    torques.segment<3>(static_cast<Eigen::Index>(3 * i)) =
        disturbance_torques_body_N_m(known, states[i]).front();
  }
  std::vector<std::pair<size_t, Regression>> found;
  for (size_t c = 0; c < laws; ++c) {
    const EmpiricalLaw& law = all_[c].law;
    if (law.variable.empty() || law.shape.functions.front().form == FunctionForm::cosines) continue;
    Disturbance start = law.disturbance;
    const size_t own = law.shape.first_coefficient();
    std::vector<double> values = law.starts;
    if (own == 0) values = {0.0};
    Regression best;
    for (const double value : values) {
      if (own > 0) start.parameters[0].value = value;
      Regression r = regressed(model_with(table, runs_, start), own, states, torques);
      if (best.start.parameters.empty() || r.left < best.left) best = std::move(r);
    }
    found.emplace_back(c, std::move(best));
  }
  std::ranges::sort(found, {}, [](const auto& f) { return f.second.left; });
  for (size_t k = 0; k < std::min(most, found.size()); ++k) {
    const auto& [c, regression] = found[k];
    consider(exchange(table, all_, which_, c, regression.start, runs_, until_convergence()));
  }
}

// A formula whose residual is noise requires no refinement.
bool is_formula_that_explains(const Trial& trial, const EmpiricalLaw& law,
                              const std::vector<Observation>& runs, const Thresholds& limits) {
  return law.shape.functions.front().form == FunctionForm::decay &&
         trial.fit.chi2_per_sample() < limits.held_out.max_noise &&
         excess_sigma(trial.fit, runs, limits) < limits.search.explained_sigma;
}

}  // namespace

Trial refined_in_time(const Trial& chosen, Candidates& all, const std::vector<Observation>& runs) {
  for (size_t i = 0; i < chosen.candidates.size(); ++i) {
    const EmpiricalLaw& law = all[chosen.candidates[i]].law;
    if (law.variable != name_of(MotionVariable::time)) continue;
    double duration_s = 0.0;
    for (const Observation& seen : runs) duration_s = std::max(duration_s, seen.time_s.back());
    // The evidence from other runs is a constant offset for all refinements.
    Trial before = all.refit(chosen, runs, chosen.fit.best.runs);
    if (is_formula_that_explains(before, law, runs, all.limits)) return chosen;
    const double weighed = chosen.log_evidence - before.log_evidence;
    const size_t laws = all.size();
    Refinement refinement(before, i, all, runs);
    try {
      const Trial table = refinement.table(duration_s);
      refinement.consider(table);
      if (std::isfinite(table.fit.chi2)) {
        refinement.consider(refinement.periodic(table));
        refinement.consider_simpler(table, laws);
      }
    } catch (const NumericalError&) {
      // A motion that cannot be propagated is not refined further.
    }
    Trial best = refinement.best();
    if (best.candidates == chosen.candidates) return chosen;
    best.log_evidence += weighed;
    best.joint_significance.clear();
    best.holdout_chi2_per_sample.reset();
    best.predictive.reset();
    return best;
  }
  return chosen;
}

}  // namespace photorque
