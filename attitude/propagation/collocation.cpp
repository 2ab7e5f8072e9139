#include "attitude/propagation/collocation.h"

#include <algorithm>
#include <cmath>

#include "attitude/propagation/stage_system.h"
#include "core/snapshot.h"

namespace photorque {
namespace {

constexpr int max_iterations = 60;
constexpr int max_newton_iterations = 12;

double dot(const gauss::Row& row, const Lanes& x) {
  return sum(Lanes(row) * x);
}

}  // namespace

CollocationStep::CollocationStep(const Dynamics& dynamics, double time_s, std::vector<double> y)
    : dynamics_(dynamics),
      time_s_(time_s),
      y_(std::move(y)),
      carry_(y_.size(), 0.0),
      increments_(y_.size()),
      accepted_increments_(y_.size()),
      stages_(y_.size()),
      rates_(y_.size()) {
  const bool about_axis = dynamics.model().platform.turns_about_one_axis();
  for (const Disturbance& d : dynamics.model().disturbances) {
    is_abrupt_ |= d.is_abrupt && !(d.is_dry_friction && about_axis);
  }
  for (const double scale : dynamics.scales()) inverse_scales_.push_back(1.0 / scale);
}

Lanes CollocationStep::stage_times_s() const {
  return time_s_ + h_s_ * Lanes(gauss::nodes);
}

void CollocationStep::predict(double h_s, const ZeroOrderHold& held) {
  if (has_polynomial_) {
    const double ratio = h_s / accepted_h_s_;
    if (ratio != continuation_ratio_) {
      continuation_ = gauss::continuation_columns(ratio);
      continuation_ratio_ = ratio;
    }
    for (size_t c = 0; c < y_.size(); ++c) {
      increments_[c] = gauss::times(continuation_, accepted_increments_[c]);
    }
    return;
  }
  std::copy(y_.begin(), y_.end(), stages_.begin());
  dynamics_.rates(time_s_ + h_s * Lanes(gauss::nodes), held, stages_.data(), rates_.data());
  for (size_t c = 0; c < y_.size(); ++c) increments_[c] = h_s * Lanes(gauss::weights) * rates_[c];
}

// Predicts the increments. Returns the size of the state in units of its scales (at least 1), to
// which rounding errors are relative.
double CollocationStep::begin_attempt(double h_s, const ZeroOrderHold& held) {
  predict(h_s, held);
  h_s_ = h_s;
  double size = 1.0;
  for (size_t c = 0; c < y_.size(); ++c) {
    size = std::max(size, inverse_scales_[c] * std::abs(y_[c]));
  }
  return size;
}

void CollocationStep::place_stages() {
  for (size_t c = 0; c < y_.size(); ++c) {
    stages_[c] = y_[c] + (carry_[c] + gauss::times(gauss::mu_columns, increments_[c]));
  }
}

// Repeats `improve` until the increments settle. It computes better increments from the rates at
// the stages and calls its argument with the change of each, in units of the scales.
template <class Improve>
CollocationStep::Outcome CollocationStep::iterate(const ZeroOrderHold& held, int most_iterations,
                                                  Settling settling, const Improve& improve) {
  const Lanes times_s = stage_times_s();
  Outcome outcome;
  while (outcome.iterations < most_iterations) {
    ++outcome.iterations;
    place_stages();
    dynamics_.rates(times_s, held, stages_.data(), rates_.data());
    Lanes largest_change = 0.0, finite = 0.0;
    improve([&](const Lanes& moved) {
      largest_change = larger_magnitude(largest_change, moved);
      finite += moved;
    });
    const double change = std::isfinite(sum(finite)) ? largest(largest_change) : sum(finite);
    const Settling::Verdict verdict = settling.judge(change);
    if (verdict == Settling::Verdict::failed) return outcome;
    if (verdict == Settling::Verdict::settled) {
      outcome.converged = true;
      outcome.error = estimate_error();
      if (is_abrupt_) outcome.error = std::max(outcome.error, estimate_error_of_ends(held));
      return outcome;
    }
  }
  return outcome;
}

CollocationStep::Outcome CollocationStep::attempt(double h_s, const ZeroOrderHold& held,
                                                  double settled) {
  const double size = begin_attempt(h_s, held);
  is_stiff_ = false;
  const Lanes weighted_h_s = h_s * Lanes(gauss::weights);
  return iterate(held, max_iterations, Settling(settled, 1e-14 * size), [&](const auto& note) {
    for (size_t c = 0; c < y_.size(); ++c) {
      const Lanes increment = weighted_h_s * rates_[c];
      note(inverse_scales_[c] * (increment - increments_[c]));
      increments_[c] = increment;
    }
  });
}

CollocationStep::Outcome CollocationStep::attempt_stiff(double h_s, const ZeroOrderHold& held,
                                                        double settled) {
  const double size = begin_attempt(h_s, held);
  is_stiff_ = true;
  if (state_blocks_.empty()) state_blocks_ = state_blocks(dynamics_);
  const Lanes weighted_h_s = h_s * Lanes(gauss::weights);
  std::vector<Lanes> move(y_.size());
  const Settling settling(settled, 1e-14 * size, 3);
  const Outcome outcome = iterate(held, max_newton_iterations, settling, [&](const auto& note) {
    for (size_t c = 0; c < y_.size(); ++c) move[c] = weighted_h_s * rates_[c] - increments_[c];
    rate_derivatives(dynamics_, state_blocks_, stage_times_s(), held, stages_.data(), room_);
    StageSystem(y_.size(), h_s, room_.jacobian).solve(move, 1);
    for (size_t c = 0; c < y_.size(); ++c) {
      note(inverse_scales_[c] * move[c]);
      increments_[c] += move[c];
    }
  });
  if (outcome.converged) {
    place_stages();
    stiffness_ = h_s * stiffness_1_s(room_.jacobian, dynamics_.scales());
  }
  return outcome;
}

// Estimates two errors from the decrease of the Legendre terms of the rates. Between the ends, the
// polynomial lacks the terms from the ninth on, which are smaller than the last term kept. At the
// end, the terms from the seventeenth on are missing, because sums at Gauss points are exact up to
// there. They are extrapolated from the decrease of the last four terms. The terms of a fast
// oscillation under a slow motion do not decrease, and its errors would accumulate over the steps.
// Therefore the bound at the end is `end_fraction` of the bound between the ends.
double CollocationStep::estimate_error() const {
  constexpr double end_fraction = 1e-3;
  double error = 0.0;
  for (size_t c = 0; c < y_.size(); ++c) {
    const auto term = [&](size_t k) {
      return std::abs(dot(gauss::projection[k], increments_[c])) /
             (2.0 * static_cast<double>(k) + 1);
    };
    const double last = std::max(term(7), 0.1 * term(6));
    const double fall = std::min(1.0, std::max(term(7), term(6)) / std::max(term(5), term(4)));
    const double square = fall * fall;
    const double at_end = last * square * square / end_fraction;
    error = std::max(error, inverse_scales_[c] * std::max(last, at_end));
  }
  return error;
}

// Estimates an error that the stages do not show: a thin layer between an end of the step and the
// nearest stage, for example where friction changes its sign. The rates at that end then differ
// from the polynomial. The error is this difference times the interval between end and stage.
double CollocationStep::estimate_error_of_ends(const ZeroOrderHold& held) const {
  constexpr double just_inside = 1.0 - 1e-12;  // a law may jump at the end itself
  const std::vector<double> end_y = end();
  std::vector<Lanes> y(y_.size()), rates(y_.size());
  for (size_t c = 0; c < y.size(); ++c) {
    y[c] = end_y[c];
    y[c].set(0, y_[c]);
  }
  Lanes times_s = time_s_ + just_inside * h_s_;
  times_s.set(0, time_s_);
  dynamics_.rates(times_s, held, y.data(), rates.data());
  double error = 0.0;
  for (size_t c = 0; c < y.size(); ++c) {
    double at_start = 0.0, at_end = 0.0;
    for (size_t k = 0; k < gauss::points; ++k) {
      const double term = dot(gauss::projection[k], increments_[c]);
      at_start += k % 2 == 0 ? term : -term;
      at_end += term;
    }
    const double missed =
        std::max(std::abs(h_s_ * rates[c][0] - at_start), std::abs(h_s_ * rates[c][1] - at_end));
    error = std::max(error, inverse_scales_[c] * gauss::nodes[0] * missed);
  }
  return error;
}

std::vector<double> CollocationStep::end() const {
  std::vector<double> y(y_.size());
  for (size_t c = 0; c < y.size(); ++c) y[c] = y_[c] + (carry_[c] + sum(increments_[c]));
  return y;
}

void CollocationStep::accept(double end_s) {
  for (size_t c = 0; c < y_.size(); ++c) {
    const double increment = carry_[c] + sum(increments_[c]);
    const double y = y_[c] + increment;
    carry_[c] = increment - (y - y_[c]);
    y_[c] = y;
  }
  time_s_ = end_s;
  std::swap(increments_, accepted_increments_);
  accepted_h_s_ = h_s_;
  has_polynomial_ = true;
}

void CollocationStep::set_component(int index, double value) {
  y_[static_cast<size_t>(index)] = value;
  carry_[static_cast<size_t>(index)] = 0.0;
}

void CollocationStep::dense(const Lanes& fraction, Lanes* y) const {
  const gauss::DenseWeights polynomial = gauss::dense_weights(fraction);
  for (size_t c = 0; c < y_.size(); ++c) {
    y[c] = y_[c] + (carry_[c] + gauss::times(polynomial, increments_[c]));
  }
}

void CollocationStep::keep(Snapshot& snapshot) {
  snapshot(time_s_, h_s_, is_stiff_, stiffness_, has_polynomial_, accepted_h_s_);
  for (std::vector<double>* values : {&y_, &carry_}) snapshot.fixed(*values);
  for (std::vector<Lanes>* values : {&increments_, &accepted_increments_}) snapshot.fixed(*values);
}

}  // namespace photorque
