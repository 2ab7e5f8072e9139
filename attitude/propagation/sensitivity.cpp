#include "attitude/propagation/sensitivity.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "attitude/model/disturbance.h"
#include "attitude/propagation/stage_system.h"

namespace photorque {

namespace {

constexpr int max_sweeps = 100;

bool only_reads(const Dynamics& dynamics, const Variable& variable) {
  return variable.initial < 0 &&
         dynamics.model().disturbances[variable.disturbance].stage == Stage::measurement;
}

// The variables on which the motion depends: parameters of instruments change only readings.
std::vector<size_t> moving_among(const std::vector<Variable>& variables, const Dynamics& dynamics) {
  std::vector<size_t> moving;
  for (size_t v = 0; v < variables.size(); ++v) {
    if (!only_reads(dynamics, variables[v])) moving.push_back(v);
  }
  return moving;
}

bool is_zero(const Lanes& x) {
  return largest(larger_magnitude(x, 0.0)) == 0.0;
}

}  // namespace

std::vector<double> tangent(std::span<const double> y, std::span<const double> change) {
  const Quat q(y[0], y[1], y[2], y[3]);
  const Quat dq(change[0], change[1], change[2], change[3]);
  const Vec3 rotation = 2.0 * (q.conjugate() * dq).vec() / q.squaredNorm();
  std::vector<double> result = {rotation[0], rotation[1], rotation[2]};
  result.insert(result.end(), change.begin() + component::rate, change.end());
  return result;
}

Sensitivity::Sensitivity(const Dynamics& dynamics, std::vector<Variable> variables,
                         std::span<const double> y)
    : dynamics_(dynamics),
      variables_(std::move(variables)),
      moving_(moving_among(variables_, dynamics)) {
  const size_t n = static_cast<size_t>(dynamics.size()), count = variables_.size();
  start_.assign(n * count, 0.0);
  increments_.assign(n * count, Lanes(0.0));
  accepted_increments_ = increments_;
  source_ = increments_;

  const Quat q(y[0], y[1], y[2], y[3]);
  for (size_t v = 0; v < count; ++v) {
    const int initial = variables_[v].initial;
    if (initial < 0) {
      seed_states_of_axis(v, {y[component::rate], y[component::rate + 1], y[component::rate + 2]});
      continue;
    }
    if (initial < 3) {
      Quat half_turn(0.0, 0.0, 0.0, 0.0);
      half_turn.vec()[initial] = 0.5;
      const Quat dq = q * half_turn;
      const std::array<double, 4> components = {dq.w(), dq.x(), dq.y(), dq.z()};
      for (size_t c = 0; c < 4; ++c) start_[c * count + v] = components[c];
    } else {
      // The attitude has three tangent components and four state components, so the indices of all
      // later components differ by one.
      start_[static_cast<size_t>(initial + 1) * count + v] = 1.0;
    }
    if (initial >= 3 && initial < 6) seed_bound_states(v, initial - 3);
  }
  largest_.assign(count, 0.0);
  largest_scaled_.assign(count, 0.0);
  note_extent();
  make_blocks();
  if (dynamics_.offsets()) read_offsets();
}

void Sensitivity::note_extent() {
  const size_t count = variables_.size();
  for (size_t i = 0; i < start_.size(); ++i) {
    const double size = std::abs(start_[i]);
    double &largest = largest_[i % count], &scaled = largest_scaled_[i % count];
    largest = std::max(largest, size);
    scaled = std::max(scaled, size / dynamics_.scales()[i / count]);
  }
}

// Derivatives of extra states that start at rest relative to the body, with respect to the initial
// rate.
void Sensitivity::seed_bound_states(size_t v, int axis) {
  const auto& disturbances = dynamics_.model().disturbances;
  for (size_t d = 0; d < disturbances.size(); ++d) {
    size_t component = static_cast<size_t>(dynamics_.first_state(d));
    for (const ExtraState& state : disturbances[d].states) {
      start_[component++ * variables_.size() + v] = bound_axis(disturbances[d], state)[axis];
    }
  }
}

// Derivatives of extra states that start at rest relative to the body, with respect to the
// parameters of their axis.
void Sensitivity::seed_states_of_axis(size_t v, const Vec3& rate_body_rad_s) {
  const Variable& variable = variables_[v];
  const Disturbance& disturbance = dynamics_.model().disturbances[variable.disturbance];
  size_t component = static_cast<size_t>(dynamics_.first_state(variable.disturbance));
  for (const ExtraState& state : disturbance.states) {
    start_[component++ * variables_.size() + v] =
        bound_rate_slope(disturbance, state, variable.parameter, rate_body_rad_s);
  }
}

void Sensitivity::make_blocks() {
  state_blocks_ = state_blocks(dynamics_);
  // Parameters of early stages affect every disturbance, and those of instruments affect only
  // readings. Each group has separate blocks.
  const auto kind = [&](const Variable& v) {
    const Stage stage = dynamics_.model().disturbances[v.disturbance].stage;
    return stage < Stage::torque ? 0 : stage == Stage::torque ? 1 : 2;
  };
  for (const int wanted : {0, 1, 2}) {
    size_t k = DualLanes::block;
    for (size_t v = 0; v < variables_.size(); ++v) {
      const Variable& variable = variables_[v];
      if (variable.initial >= 0 || kind(variable) != wanted) continue;
      if (k == DualLanes::block) {
        parameter_blocks_.emplace_back();
        parameter_blocks_.back().variable.fill(-1);
        k = 0;
      }
      ParameterBlock& last = parameter_blocks_.back();
      last.block.parameter[k] =
          dynamics_.first_parameter(variable.disturbance) + variable.parameter;
      last.variable[k++] = static_cast<int>(v);
    }
  }
}

// Offsets depend only on the parameters of the instruments, and these derivatives are constant.
void Sensitivity::read_offsets() {
  const size_t count = variables_.size();
  offset_slopes_.assign(Dynamics::reading_count * count, 0.0);
  const PlatformState any = dynamics_.initial_state();
  const std::vector<double> start = to_vector(any);
  const std::vector<Lanes> y(start.begin(), start.end());
  std::array<Lanes, Dynamics::reading_count * DualLanes::block> partials;
  Dynamics::Workspace room;
  for (const ParameterBlock& block : parameter_blocks_) {
    if (!only_reads(dynamics_, variables_[static_cast<size_t>(block.variable[0])])) continue;
    dynamics_.reading_derivatives(Lanes(any.time_s), {}, y.data(), block.block, partials.data(),
                                  room);
    for (size_t i = 0; i < partials.size(); ++i) {
      const size_t r = i / DualLanes::block, k = i % DualLanes::block;
      if (block.variable[k] < 0) continue;
      offset_slopes_[r * count + static_cast<size_t>(block.variable[k])] = partials[i][0];
    }
  }
}

void Sensitivity::differentiate_rates(const CollocationStep& step, const ZeroOrderHold& held) {
  const size_t n = static_cast<size_t>(dynamics_.size()), count = variables_.size();
  rate_derivatives(dynamics_, state_blocks_, step.stage_times_s(), held, step.stages().data(),
                   room_);
  std::vector<Lanes>& partials = room_.partials;
  for (const ParameterBlock& block : parameter_blocks_) {
    if (only_reads(dynamics_, variables_[static_cast<size_t>(block.variable[0])])) continue;
    dynamics_.derivatives(step.stage_times_s(), held, step.stages().data(), block.block,
                          partials.data(), room_.evaluation);
    for (size_t c = 0; c < n; ++c) {
      for (size_t k = 0; k < DualLanes::block; ++k) {
        if (block.variable[k] < 0) continue;
        source_[c * count + static_cast<size_t>(block.variable[k])] =
            partials[c * DualLanes::block + k];
      }
    }
  }
}

bool Sensitivity::solve(const CollocationStep& step, const ZeroOrderHold& held, double tolerance) {
  differentiate_rates(step, held);
  h_s_ = step.length_s();
  if (step.is_stiff()) {
    solve_at_once(step);
    return is_resolved(step);
  }
  predict();
  sort_jacobian();
  for (size_t first = 0; first < moving_.size(); first += group_size) {
    if (!settle(first, tolerance)) return false;
  }
  return is_resolved(step);
}

// First guess of the increments: the extrapolated polynomials of the previous step.
void Sensitivity::predict() {
  if (!has_polynomial_) {
    std::fill(increments_.begin(), increments_.end(), Lanes(0.0));
    return;
  }
  const size_t count = variables_.size();
  const auto continuation = gauss::continuation_columns(h_s_ / accepted_h_s_);
  for (size_t row = 0; row < start_.size(); row += count) {
    for (const size_t v : moving_) {
      increments_[row + v] = gauss::times(continuation, accepted_increments_[row + v]);
    }
  }
}

// Sorts by rows, the order in which settle() reads the entries.
void Sensitivity::sort_jacobian() {
  std::sort(room_.jacobian.begin(), room_.jacobian.end(),
            [](const RateDerivative& a, const RateDerivative& b) {
              return std::pair(a.row, a.column) < std::pair(b.row, b.column);
            });
}

// Solves for `group_size` variables from moving_[first] on by Gauss–Seidel iteration: every
// component uses the newest stages of the others. A small group fits into the cache and needs only
// the iterations of its slowest variable.
bool Sensitivity::settle(size_t first, double tolerance) {
  struct Column {
    double start;
    Lanes source, increment, stage;
  };
  using Row = std::array<Column, group_size>;
  const size_t count = variables_.size(), n = start_.size() / count;
  std::array<size_t, group_size> variable;
  for (size_t k = 0; k < group_size; ++k) {
    variable[k] = moving_[std::min(first + k, moving_.size() - 1)];
  }
  std::vector<Row> rows(n);
  for (size_t c = 0; c < n; ++c) {
    for (size_t k = 0; k < group_size; ++k) {
      const size_t i = c * count + variable[k];
      rows[c][k] = {start_[i], source_[i], increments_[i],
                    start_[i] + gauss::times(gauss::mu_columns, increments_[i])};
    }
  }
  const Lanes weighted_h_s = h_s_ * Lanes(gauss::weights);
  // The system is linear with the same contraction rate as the stages, which have converged, so the
  // iteration normally converges. Mixed units may make the first changes grow. The iteration fails
  // if a mode without amplitude let the stages converge in a step that is too long for it.
  constexpr int max_stalled_changes = 25;
  Settling settling(tolerance, 1e-13, max_stalled_changes);
  for (int iteration = 1; iteration <= max_sweeps; ++iteration) {
    std::array<Lanes, group_size> size{}, moved{};
    auto entry = room_.jacobian.begin();
    for (size_t c = 0; c < n; ++c) {
      std::array<Lanes, group_size> rate;
      for (size_t k = 0; k < group_size; ++k) rate[k] = rows[c][k].source;
      for (; entry != room_.jacobian.end() && entry->row == c; ++entry) {
        const Row& from = rows[entry->column];
        for (size_t k = 0; k < group_size; ++k) rate[k] += entry->value * from[k].stage;
      }
      for (size_t k = 0; k < group_size; ++k) {
        Column& to = rows[c][k];
        const Lanes increment = weighted_h_s * rate[k];
        moved[k] = larger_magnitude(moved[k], increment - to.increment);
        to.increment = increment;
        to.stage = to.start + gauss::times(gauss::mu_columns, increment);
        size[k] = larger_magnitude(size[k], to.stage);
      }
    }
    // Derivatives with respect to different variables have different units, so each has a separate
    // scale.
    double change = 0.0;
    for (size_t k = 0; k < group_size; ++k) {
      const double of_size = std::max(largest(size[k]), next_to_nothing * largest_[variable[k]]);
      if (of_size > 0.0) change = std::max(change, largest(moved[k]) / of_size);
    }
    const Settling::Verdict verdict = settling.judge(change);
    if (verdict == Settling::Verdict::failed) return false;
    if (verdict == Settling::Verdict::settled) {
      for (size_t c = 0; c < n; ++c) {
        for (size_t k = 0; k < group_size; ++k) {
          increments_[c * count + variable[k]] = rows[c][k].increment;
        }
      }
      return true;
    }
  }
  return false;
}

// Solves z = h b (s + J (start + μ z)) directly, because an iteration would not converge.
void Sensitivity::solve_at_once(const CollocationStep& step) {
  const size_t count = variables_.size();
  increments_ = source_;
  for (const RateDerivative& entry : room_.jacobian) {
    const double* from = start_.data() + entry.column * count;
    Lanes* to = increments_.data() + entry.row * count;
    for (size_t v = 0; v < count; ++v) to[v] += entry.value * from[v];
  }
  const Lanes weighted_h_s = h_s_ * Lanes(gauss::weights);
  for (Lanes& x : increments_) x = weighted_h_s * x;
  StageSystem(step.start().size(), h_s_, room_.jacobian).solve(increments_, count);
}

// Whether the step is short enough for the derivatives. The criterion is the last Legendre term of
// their polynomials, relative to the largest value of each derivative in units of the scales.
bool Sensitivity::is_resolved(const CollocationStep& step) const {
  constexpr double tolerance = 1e-3;
  const size_t count = variables_.size(), n = step.start().size();
  for (size_t v = 0; v < count; ++v) {
    double size = next_to_nothing / tolerance * largest_scaled_[v], last = 0.0;
    for (size_t c = 0; c < n; ++c) {
      const double per_scale = 1.0 / dynamics_.scales()[c];
      const size_t i = c * count + v;
      const double change = sum(increments_[i]);
      size =
          std::max(size, per_scale * std::max(std::abs(start_[i]), std::abs(start_[i] + change)));
      last =
          std::max(last, per_scale * std::abs(sum(Lanes(gauss::projection[7]) * increments_[i])));
    }
    if (last > 15.0 * tolerance * size) return false;  // ∫P₇ is at most 1/15
  }
  return true;
}

void Sensitivity::accept() {
  for (size_t i = 0; i < start_.size(); ++i) start_[i] += sum(increments_[i]);
  std::swap(increments_, accepted_increments_);
  note_extent();
  accepted_h_s_ = h_s_;
  has_polynomial_ = true;
}

void Sensitivity::add(size_t v, std::span<const double> change) {
  for (size_t c = 0; c < change.size(); ++c) start_[c * variables_.size() + v] += change[c];
  note_extent();
}

void Sensitivity::dense(const Lanes& fraction, Lanes* derivatives) const {
  const gauss::DenseWeights polynomial = gauss::dense_weights(fraction);
  const size_t count = variables_.size(), n = static_cast<size_t>(dynamics_.size());
  std::fill_n(derivatives, n * count, Lanes(0.0));
  for (size_t c = 0; c < n; ++c) {
    for (const size_t v : moving_) {
      const size_t i = c * count + v;
      derivatives[i] = start_[i] + gauss::times(polynomial, increments_[i]);
    }
  }
}

void Sensitivity::readings(const Lanes& time_s, const std::array<ZeroOrderHold, Lanes::count>& held,
                           const Lanes* y, const Lanes* derivatives, Lanes* readings) const {
  const size_t count = variables_.size();
  if (dynamics_.offsets()) {
    std::copy(offset_slopes_.begin(), offset_slopes_.end(), readings);
    const Lanes* by_rate = derivatives + component::rate * count;
    for (size_t i = 0; i < 3 * count; ++i) readings[i] += by_rate[i];
    return;
  }
  std::fill(readings, readings + Dynamics::reading_count * count, Lanes(0.0));
  std::array<Lanes, Dynamics::reading_count * DualLanes::block> partials;
  Dynamics::Workspace room;
  for (const Dynamics::Block& block : state_blocks_) {
    dynamics_.reading_derivatives(time_s, held, y, block, partials.data(), room);
    for (size_t i = 0; i < partials.size(); ++i) {
      const size_t r = i / DualLanes::block, k = i % DualLanes::block;
      if (block.state[k] < 0 || is_zero(partials[i])) continue;
      const Lanes* from = derivatives + static_cast<size_t>(block.state[k]) * count;
      for (size_t v = 0; v < count; ++v) readings[r * count + v] += partials[i] * from[v];
    }
  }
  // Parameters of masses and torques affect the readings only through the state.
  const auto reaches_instruments = [&](int variable) {
    if (variable < 0) return false;
    const size_t d = variables_[static_cast<size_t>(variable)].disturbance;
    const Stage stage = dynamics_.model().disturbances[d].stage;
    return stage != Stage::mass && stage != Stage::torque;
  };
  for (const ParameterBlock& block : parameter_blocks_) {
    if (std::none_of(block.variable.begin(), block.variable.end(), reaches_instruments)) continue;
    dynamics_.reading_derivatives(time_s, held, y, block.block, partials.data(), room);
    for (size_t i = 0; i < partials.size(); ++i) {
      const size_t r = i / DualLanes::block, k = i % DualLanes::block;
      if (block.variable[k] < 0) continue;
      readings[r * count + static_cast<size_t>(block.variable[k])] += partials[i];
    }
  }
}

}  // namespace photorque
