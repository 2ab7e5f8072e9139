#include "attitude/observation/prediction.h"

#include <algorithm>
#include <cmath>

#include "attitude/observation/blocks.h"
#include "attitude/observation/expected_readings.h"
#include "attitude/propagation/sampling.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/median.h"

namespace photorque {

MeanOfCorrelated mean_of_correlated(double n, double steps) {
  if (n < 1.0) return {1.0 / n};
  constexpr double longest_means = 20.0;
  steps = std::min(steps, longest_means / n);
  if (n == 1.0 || !(steps > 0.0)) return {};  // one reading, or all of them equal
  const double rho = std::exp(-steps), left = -std::expm1(-steps);
  const double variance =
      ((1.0 + rho) / left + 2.0 * rho * std::expm1(-n * steps) / (n * left * left)) / n;
  return {variance, std::sinh(0.5 * n * steps) / (n * std::sinh(0.5 * steps))};
}

double reading_interval_s(const Observation& seen, int channel) {
  std::vector<double> intervals_s;
  double last_s = NAN, last_rows = 0.0;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    const double rows = seen.rows_of(i, channel);
    if (!(rows > 0.0)) continue;
    if (std::isfinite(last_s)) {
      intervals_s.push_back(2.0 * (seen.time_s[i] - last_s) /
                            (std::max(1.0, rows) + std::max(1.0, last_rows)));
    }
    last_s = seen.time_s[i];
    last_rows = rows;
  }
  return intervals_s.empty() ? 0.0 : upper_median(std::move(intervals_s));
}

Whitening::Whitening(const Observation& seen, int channel, Eigen::Index width)
    : profile_(seen.profile) {
  const ChannelNoise noise = seen.noise.of(channel);
  level_ = noise.level;
  if (!(noise.coloured > 0.0) || !(noise.time_s > 0.0)) return;
  coloured_ = true;
  coloured_variance_ = noise.coloured * level_ * level_;
  white_variance_ = std::max(0.0, 1.0 - noise.coloured) * level_ * level_;
  time_s_ = noise.time_s;
  interval_s_ = reading_interval_s(seen, channel);
  variance_ = coloured_variance_;
  last_s_ = seen.time_s.front();
  expected_ = Eigen::RowVectorXd::Zero(width);
}

Whitening::Gain Whitening::gain(double time_s, double rows) {
  const MeanOfCorrelated mean = mean_of_correlated(rows, interval_s_ / time_s_);
  const double own = white_variance_ / rows + coloured_variance_ * mean.variance;
  const double scale = 1.0 / mean.reach;
  // Variance that only this block has. It is negative for means, whose correlation is larger than
  // that of the process at their centres.
  const double alone = own * scale * scale - coloured_variance_;
  const double decay = std::exp(-(time_s - last_s_) / time_s_);
  variance_ = coloured_variance_ + decay * decay * (variance_ - coloured_variance_);
  last_s_ = time_s;
  // Lower bound of the variance, which would be zero for blocks that are closer than their
  // readings.
  constexpr double least = 1e-6;
  const double total = std::max(variance_ + alone, least * own * scale * scale);
  const double gain = variance_ / total;
  variance_ *= 1.0 - gain;
  return {decay, scale, gain, 1.0 / std::sqrt(total)};
}

namespace {

// Mean over the evaluation times of a block. The mean attitude corresponds to that of the readings
// (blocks.cpp): with the constant rate that leaves no trend, the two outer attitudes move to the
// middle between them.
ExpectedInstant mean_of(const std::vector<ExpectedInstant>& all, const BlockInstants& instants,
                        size_t block, double time_s) {
  if (all.size() == 1) {
    ExpectedInstant only = all.front();
    only.gyro_mean_rad_s = only.gyro_rad_s;
    return only;
  }
  const ExpectedInstant &first = all.front(), &last = all.back();
  ExpectedInstant mean;
  mean.state = first.state;
  mean.state.time_s = time_s;
  mean.state.rate_body_rad_s.setZero();
  for (size_t i = 0; i < all.size(); ++i) {
    const double weight = instants.weight(block, i);
    mean.state.rate_body_rad_s += weight * all[i].state.rate_body_rad_s;
    mean.camera_offset_body += weight * all[i].camera_offset_body;
    mean.gyro_rad_s += weight * all[i].gyro_rad_s;
    mean.gyro_mean_rad_s += instants.gyro_weight(block, i) * all[i].gyro_rad_s;
    mean.fields += weight * all[i].fields;
    mean.place += weight * all[i].place;
  }
  const Quat &before = first.state.lab_from_body, &after = last.state.lab_from_body;
  const Quat middle =
      (before * turn_by(0.5 * turn_vector(before.conjugate() * after))).normalized();
  Vec3 turn_rad = Vec3::Zero();
  if (all.size() == 3) {
    turn_rad =
        instants.weight(block, 1) * turn_vector(middle.conjugate() * all[1].state.lab_from_body);
  }
  // The times of attitudes may have a smaller spread than those of other readings.
  const double between_s = instants.since_s(block, all.size() - 1) - instants.since_s(block, 0);
  if (between_s > 0.0) {
    const Vec3 acceleration_rad_s2 =
        (last.state.rate_body_rad_s - first.state.rate_body_rad_s) / between_s;
    turn_rad += 0.5 * instants.attitudes_excess_s2(block) * acceleration_rad_s2;
  }
  mean.state.lab_from_body = (middle * turn_by(turn_rad)).normalized();
  return mean;
}

class Comparison {
 public:
  Comparison(const Platform& platform, const Observation& seen, const BlockInstants& instants,
             double fastest_rad_s, size_t variables, bool keep, double max_chi2)
      : platform_(platform),
        seen_(seen),
        instants_(instants),
        max_chi2_(max_chi2),
        max_rate_rad_s_(runaway * fastest_rad_s),
        sums_(static_cast<Eigen::Index>(variables)),
        slope_(Eigen::Index{channel_count}, static_cast<Eigen::Index>(variables)),
        keep_(keep) {
    slope_.setZero();
    for (int channel = 0; channel < channel_count; ++channel) {
      whitening_.emplace_back(seen, channel, slope_.cols() + 1);
      if (channel >= vector_channels && seen.has_channel(channel)) {
        scalars_.push_back(channel - vector_channels);
      }
    }
  }

  void add(const Dynamics& dynamics, const Sensitivity* sensitivity, const Samples& samples) {
    ExpectedReadings expected = expected_readings(dynamics, sensitivity, samples, seen_, scalars_);
    // Stops early, because the rest would not improve the decision.
    if (chi2_ > max_chi2_) throw NumericalError("the prediction has diverged from the readings");
    for (int lane = 0; lane < samples.count; ++lane) {
      const size_t instant = samples.first + static_cast<size_t>(lane),
                   block = instant / instants_.per_block();
      moments_.push_back(std::move(expected.instant[static_cast<size_t>(lane)]));
      if (!(moments_.back().state.rate_body_rad_s.norm() < max_rate_rad_s_)) {
        throw NumericalError("the motion runs away");
      }
      SlopeRows& slope = expected.slope[static_cast<size_t>(lane)];
      if (sensitivity != nullptr && moments_.size() == 1) slope_.setZero();
      if (sensitivity != nullptr) slope_ += instants_.weight(block, moments_.size() - 1) * slope;
      if (moments_.size() < instants_.per_block()) continue;
      add_block(block, mean_of(moments_, instants_, block, seen_.time_s[block]));
      moments_.clear();
    }
  }

  Prediction finish() {
    result_.sums = sums_.finish();
    return std::move(result_);
  }

 private:
  void add_block(size_t block, const ExpectedInstant& moment) {
    const PlatformState& state = moment.state;
    const Vec3 &camera_offset_body = moment.camera_offset_body, &gyro_rad_s = moment.gyro_rad_s;
    WhiteRow white = WhiteRow::Constant(NAN), off = white;
    if (seen_.attitude_rows[block] > 0.0 && seen_.has_some_attitude()) {
      off.head<3>() = turn_vector(seen_.attitude[block] * state.lab_from_body.conjugate()) -
                      state.lab_from_body * camera_offset_body;
      if (platform_.turns_about_one_axis()) count_turns(off);
    }
    off.segment<3>(3) = seen_.gyro_rad_s[block] - moment.gyro_mean_rad_s;
    if (instants_.per_block() > 1) off.segment<3>(3) -= seen_.spread[block].gyro_moved_rad_s;
    Eigen::Matrix<double, scalar_count, 1> scalars = Eigen::Matrix<double, scalar_count, 1>::Zero();
    for (const int s : scalars_) {
      const ScalarReadings& read = seen_.scalar[static_cast<size_t>(s)];
      if (s >= first_field) {
        scalars[s] =
            s < first_place ? moment.fields[s - first_field] : moment.place[s - first_place];
        off[vector_channels + s] = read.value[block] - scalars[s];
        continue;  // its derivatives are already filled
      }
      const auto which = static_cast<Scalar>(s);
      const Vec3 camera_offset_lab = state.lab_from_body * camera_offset_body;
      const Quat as_seen = turn_by(camera_offset_lab) * state.lab_from_body;
      const ScalarReading reading = scalar_reading(which, as_seen, gyro_rad_s);
      scalars[s] = reading.value;
      off[vector_channels + s] = scalar_difference(which, read.value[block], reading.value);
      slope_.row(vector_channels + s) = reading.by_rotation_lab.transpose() * slope_.topRows<3>() +
                                        reading.by_rate.transpose() * slope_.middleRows<3>(3);
    }
    for (int channel = 0; channel < channel_count; ++channel) {
      const double rows = seen_.rows_of(block, channel);
      if (rows > 0.0) white[channel] = put(channel, block, rows, off[channel]);
      if (!(rows > 0.0)) off[channel] = NAN;
    }
    if (!keep_) return;
    result_.residual.push_back(white);
    result_.off.push_back(off);
    result_.states.push_back(state);
    result_.camera_offset_lab_rad.emplace_back(state.lab_from_body * camera_offset_body);
    result_.gyro_rad_s.push_back(moment.gyro_mean_rad_s);
    result_.scalars.push_back(scalars);
  }

  // Counts whole turns about the only axis: a prediction that lags by more than half a turn has an
  // error of that size. Between readings the error changes by less than half a turn.
  void count_turns(WhiteRow& off) {
    const Vec3& axis = platform_.axis;
    const double along_rad = axis.dot(off.head<3>());
    const double turns = std::round((off_before_rad_ - along_rad) / (2.0 * pi));
    off_before_rad_ = along_rad + 2.0 * pi * turns;
    off.head<3>() += 2.0 * pi * turns * axis;
  }

  // Whitens the residual and its derivatives. Returns the whitened residual.
  double put(int channel, size_t block, double rows, double off) {
    auto row = sums_.next();
    const Eigen::Index n = slope_.cols();
    row.head(n) = slope_.row(channel);
    row[n] = off;
    whitening_[static_cast<size_t>(channel)].apply(seen_.time_s[block], rows, row);
    chi2_ += row[n] * row[n];
    return row[n];
  }

  // Largest predicted rate relative to the fastest observed one; above it, a trial is given up.
  static constexpr double runaway = 20.0;

  const Platform& platform_;
  const Observation& seen_;
  const BlockInstants& instants_;
  double off_before_rad_ = 0.0;  // about the only axis
  double max_chi2_, max_rate_rad_s_, chi2_ = 0.0;
  inference::SumsOfRows sums_;
  SlopeRows slope_;
  std::vector<ExpectedInstant> moments_;  // of the present, incomplete block
  std::vector<int> scalars_;              // that were read
  std::vector<Whitening> whitening_;      // of each channel
  bool keep_;
  Prediction result_;
};

}  // namespace

Prediction predict(const Dynamics& dynamics, const PlatformState& initial, const Observation& seen,
                   const std::vector<Variable>& variables, const PredictionOptions& options) {
  const size_t blocks = std::min(options.blocks, seen.blocks());
  const double fastest = fastest_rad_s(seen);
  const BlockInstants instants(seen, fastest);
  Comparison comparison(dynamics.model().platform, seen, instants, fastest, variables.size(),
                        options.keep_residuals, options.max_chi2);
  PropagationOptions propagation = options.propagation;
  // Limits the steps of a trial whose motion diverges. A body that friction stops needs thousands
  // of steps in a short time.
  constexpr int64_t steps_at_least = 20000;
  constexpr double steps_per_second = 40.0;
  const size_t count = blocks * instants.per_block();
  const double end_s = instants.time_s(count - 1);
  propagation.max_steps =
      steps_at_least + static_cast<int64_t>(steps_per_second * (end_s - initial.time_s));
  Propagator propagator(dynamics, initial, end_s, propagation, variables);
  sample(
      propagator, count, [&](size_t i) { return instants.time_s(i); },
      [&](const Samples& samples) {
        comparison.add(dynamics, variables.empty() ? nullptr : &*propagator.sensitivity(), samples);
      });
  return comparison.finish();
}

}  // namespace photorque
