#include "attitude/estimation/fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "attitude/disturbances/kind.h"
#include "attitude/estimation/forward_model.h"
#include "attitude/model/disturbance.h"
#include "attitude/observation/blocks.h"
#include "attitude/propagation/run.h"
#include "core/errors.h"
#include "inference/estimator/parameter.h"

namespace photorque {

Fit fit(const Hypothesis& start, const std::vector<Observation>& runs,
        const FitSettings& settings) {
  const AttitudeForwardModel model(start, runs, {}, settings.tolerance);
  Fit result{inference::fit(model, model.point_of(start), settings), {}};
  result.best = model.hypothesis_at(result.at);
  return result;
}

Hypothesis within_bounds(const Fit& fit, std::vector<Free> free,
                         const std::vector<Observation>& runs) {
  Hypothesis bounded = fit.best;
  bounded.free = std::move(free);
  const AttitudeForwardModel model(bounded, runs, {}, FitSettings().tolerance);
  const inference::Parameters at = model.parameters(fit.at);
  return model.hypothesis_at(model.stepped(fit.at, inference::step_to_bounds(fit.hessian, at)));
}

inference::SumsOfRuns sums_at(const Hypothesis& at, const std::vector<Observation>& runs,
                              const std::vector<Free>& extra, double tolerance) {
  const AttitudeForwardModel model(at, runs, extra, tolerance);
  return inference::evaluate(model, model.point_of(at), {}).sums;
}

Prediction residuals_of(const Fit& fit, size_t run, const Observation& seen) {
  PredictionOptions options;
  options.keep_residuals = true;
  const Dynamics dynamics(fit.best.model_of(run, seen));
  return predict(dynamics, fit.best.runs[run].initial, seen, {}, options);
}

std::vector<Prediction> residuals_of(const Fit& fit, const std::vector<Observation>& runs) {
  std::vector<Prediction> all;
  for (size_t run = 0; run < runs.size(); ++run) all.push_back(residuals_of(fit, run, runs[run]));
  return all;
}

namespace {

// Whitened residuals of each channel (recordings/columns.h) without gaps, one entry per run.
std::vector<inference::ChannelResiduals> channels_of(const std::vector<Prediction>& residuals) {
  std::vector<inference::ChannelResiduals> runs;
  for (const Prediction& p : residuals) {
    inference::ChannelResiduals channels(static_cast<size_t>(channel_count));
    for (const WhiteRow& row : p.residual) {
      for (size_t k = 0; k < channels.size(); ++k) {
        const double white = row[static_cast<Eigen::Index>(k)];
        if (std::isfinite(white)) channels[k].push_back(white);
      }
    }
    runs.push_back(std::move(channels));
  }
  return runs;
}

}  // namespace

double excess_sigma(const Fit& fit, const std::vector<Observation>& runs,
                    const Thresholds& thresholds) {
  const Thresholds::Noise& limits = thresholds.noise;
  // In short runs, fitting the initial state removes the means over many neighbours. Their channels
  // are also tested with shorter means, so that each has at least this number.
  constexpr size_t fewest_means = 6;
  try {
    const std::vector<inference::ChannelResiduals> channels = channels_of(residuals_of(fit, runs));
    size_t longest = 0;
    for (const auto& run : channels) {
      for (const auto& channel : run) longest = std::max(longest, channel.size());
    }
    Thresholds::Noise scale = limits;
    scale.neighbours = std::clamp(longest / fewest_means, size_t{1}, limits.neighbours);
    const double structure = std::max(inference::whiteness(channels, limits).excess_sigma,
                                      inference::whiteness(channels, scale).excess_sigma);
    return std::max(structure,
                    inference::size_excess_sigma(channels, thresholds.held_out.max_noise));
  } catch (const NumericalError&) {
    return limits.excess_unknown;
  }
}

int64_t drop_outliers(const std::vector<Prediction>& residuals, const Thresholds::Noise& limits,
                      std::vector<Observation>& runs) {
  int64_t dropped = 0;
  const std::vector<inference::ChannelResiduals> all = channels_of(residuals);
  for (size_t run = 0; run < runs.size(); ++run) {
    for (Eigen::Index k = 0; k < channel_count; ++k) {
      // Neighbours are the next readings, across gaps and empty cells.
      std::vector<size_t> rows;
      for (size_t i = 0; i < residuals[run].residual.size(); ++i) {
        if (std::isfinite(residuals[run].residual[i][k])) rows.push_back(i);
      }
      for (const size_t n : inference::outliers(all[run][static_cast<size_t>(k)], limits)) {
        // An attitude may have been dropped for another component.
        if (k >= 3 || runs[run].attitude_rows[rows[n]] > 0.0) ++dropped;
        runs[run].rows_in(rows[n], static_cast<int>(k)) = 0.0;
      }
    }
  }
  return dropped;
}

namespace {

// Sums of the residuals of neighbouring rows, which are replaced by their mean.
struct Neighbours {
  size_t first = 0, last = 0;
  double time_sum_s = 0.0;
  WhiteRow sum = WhiteRow::Zero(), rows = WhiteRow::Zero();

  void add(const Observation& from, const Prediction& propagated, size_t i) {
    if (last == first) first = i;
    last = i + 1;
    time_sum_s += from.time_s[i];
    for (int channel = 0; channel < channel_count; ++channel) {
      const double read = channel < 3 ? from.attitude_rows[i] : from.rows_of(i, channel);
      if (!(read > 0.0)) continue;
      sum[channel] += read * propagated.off[i][channel];
      rows[channel] += read;
    }
  }

  size_t middle(const Observation& from) const {
    const double mean_s = time_sum_s / static_cast<double>(last - first);
    size_t best = first;
    for (size_t i = first; i < last; ++i) {
      if (std::abs(from.time_s[i] - mean_s) < std::abs(from.time_s[best] - mean_s)) best = i;
    }
    return best;
  }

  void append_to(Observation& to, const Observation& from, const Prediction& propagated) const {
    const size_t m = middle(from);
    const size_t block = append_block(from, from.time_s[m], to);
    // Residuals have no curvature, so the spread is that of the middle row.
    if (!from.spread.empty()) {
      to.spread.push_back(from.spread[m]);
      to.spread.back().gyro_moved_rad_s.setZero();
    }
    const WhiteRow mean = sum.cwiseQuotient(rows);  // NaN without readings
    if (rows[0] > 0.0) {
      const Vec3 turn = propagated.camera_offset_lab_rad[m] + mean.head<3>();
      to.attitude[block] = (turn_by(turn) * propagated.states[m].lab_from_body).normalized();
    }
    to.attitude_rows[block] = rows[0];
    for (int channel = 3; channel < channel_count; ++channel) {
      if (!from.has_channel(channel)) continue;
      const double predicted = channel < vector_channels
                                   ? propagated.gyro_rad_s[m][channel - 3]
                                   : propagated.scalars[m][channel - vector_channels];
      to.value_of(block, channel) = predicted + mean[channel];
      to.rows_in(block, channel) = rows[channel];
    }
  }
};

Observation averaged_run(const Prediction& propagated, const Observation& seen, size_t blocks) {
  Observation result = without_blocks(seen);
  const double block_s = seen.duration_s() / static_cast<double>(blocks);
  // Half a row of tolerance, so that rounding of the times does not make uneven blocks.
  const double slack_s = 0.5 * seen.duration_s() / static_cast<double>(seen.blocks());
  Neighbours block;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    if (block.last > block.first && seen.time_s[i] > seen.time_s[block.first] + block_s - slack_s) {
      block.append_to(result, seen, propagated);
      block = {};
    }
    block.add(seen, propagated, i);
  }
  block.append_to(result, seen, propagated);
  return result;
}

}  // namespace

std::vector<Observation> averaged_about(const Fit& fit, const std::vector<Observation>& runs,
                                        size_t blocks) {
  const std::vector<Prediction> propagated = residuals_of(fit, runs);
  std::vector<Observation> result;
  for (size_t run = 0; run < runs.size(); ++run) {
    result.push_back(runs[run].blocks() <= blocks
                         ? runs[run]
                         : averaged_run(propagated[run], runs[run], blocks));
  }
  return result;
}

namespace {

// Smallest physical value of a key, from the file of its kind.
double lowest_of(const DisturbanceKind* kind, const std::string& key) {
  if (kind == nullptr) return -inference::infinity;
  if (kind->screening.minimum_sum) return kind->screening.minimum_sum->lowest;
  for (const Parametrisation& p : kind->screening.parametrisations) {
    for (const EffectKey& k : p.keys) {
      if (k.key == key && k.lowest > -EffectKey::unbounded) return k.lowest;
    }
  }
  return -inference::infinity;
}

}  // namespace

Hypothesis nominal_hypothesis(const NominalModel& nominal, const std::vector<Observation>& runs) {
  Hypothesis h;
  h.model = nominal.model;
  for (size_t d = 0; d < h.model.disturbances.size(); ++d) {
    const Disturbance& disturbance = h.model.disturbances[d];
    const DisturbanceKind* kind = find_kind(disturbance.kind);
    const bool per_run = disturbance.per_recording;
    for (size_t p = 0; p < disturbance.parameters.size(); ++p) {
      const Parameter& parameter = disturbance.parameters[p];
      if (!(parameter.sigma > 0.0)) continue;
      Free f{d, static_cast<int>(p), parameter.value, parameter.sigma, per_run};
      f.per_recording = per_run;
      // Physical bounds apply to nominal parameters too, unless the nominal value violates them.
      if (parameter.value >= lowest_of(kind, parameter.key)) {
        f.lowest = lowest_of(kind, parameter.key);
      }
      h.free.push_back(f);
    }
  }
  h.runs = starts_from_data(h, runs);
  return h;
}

size_t add_disturbance(Hypothesis& hypothesis, const Disturbance& disturbance) {
  hypothesis.model.disturbances.push_back(disturbance);
  for (RunStart& run : hypothesis.runs) {
    for (const ExtraState& state : disturbance.states) {
      run.initial.extra.push_back(
          initial_value(disturbance, state, run.initial.rate_body_rad_s, run.turned_rad));
    }
  }
  return hypothesis.model.disturbances.size() - 1;
}

Fit fit_nominal(const NominalModel& nominal, const std::vector<Observation>& runs,
                const Thresholds& limits) {
  FitSettings settings;
  settings.windows = limits.fitting.first_windows;
  Hypothesis start = nominal_hypothesis(nominal, runs);
  choose_starts(start, runs);
  return fit(start, runs, settings);
}

}  // namespace photorque
