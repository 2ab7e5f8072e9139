#include "attitude/observation/bias_history.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "attitude/observation/blocks.h"
#include "attitude/observation/camera_noise.h"
#include "core/numerics/median.h"

namespace photorque {

namespace {

// Number of blocks to which readings are averaged, because a bias changes slowly. A fast rotation
// needs more blocks: the body may rotate by at most `most_turn_rad` within one.
constexpr double usual_blocks = 1200.0, most_turn_rad = 0.1;
constexpr double knot_distance_s = 60.0;
constexpr size_t fewest_intervals = 2, most_intervals = 24;
// Spectral density of the third derivative of the angle [rad²/s⁵], large enough for any torque.
constexpr double any_roughness = 1e-2;
// The larger model is used if it decreases χ² by more than this, beyond the decrease by chance.
constexpr double least_gain = 50.0;

// The columns of a KinematicSeries (kinematics.h) that all recordings have in common.
constexpr std::array<Eigen::Index, 13> shared_columns = {6,  7,  8,  9,  10, 11, 12,
                                                         13, 14, 15, 17, 18, 19};
constexpr auto shared_count = static_cast<Eigen::Index>(shared_columns.size());

// The segments of one recording, and the knots between which its bias is linear. Even knots are
// those of the model. Odd knots halve its intervals; their decrease of χ² is that due to noise.
struct Span {
  std::string name;
  std::vector<const Observation*> pieces;
  double first_s = 0.0, last_s = 0.0;
  Eigen::Index intervals = 0;  // of the finer knots; even
  Eigen::Index first_column = 0;

  Eigen::Index knots() const { return intervals + 1; }
  double knot_s(Eigen::Index k) const {
    return first_s + (last_s - first_s) * static_cast<double>(k) / static_cast<double>(intervals);
  }
  // The knot before a time, and the weight of the next knot.
  std::pair<Eigen::Index, double> place(double t_s) const {
    const double x =
        std::clamp((t_s - first_s) / (last_s - first_s), 0.0, 1.0) * static_cast<double>(intervals);
    const Eigen::Index k = std::min(static_cast<Eigen::Index>(x), intervals - 1);
    return {k, x - static_cast<double>(k)};
  }
};

std::vector<Span> spans_of(const std::vector<const Observation*>& pieces) {
  std::vector<Span> spans;
  for (const Observation* seen : pieces) {
    auto at = std::find_if(spans.begin(), spans.end(),
                           [&](const Span& span) { return span.name == seen->name; });
    if (at == spans.end()) {
      spans.push_back({seen->name, {}, seen->time_s.front(), seen->time_s.back()});
      at = spans.end() - 1;
    }
    at->pieces.push_back(seen);
    at->first_s = std::min(at->first_s, seen->time_s.front());
    at->last_s = std::max(at->last_s, seen->time_s.back());
  }
  Eigen::Index column = shared_count;
  for (Span& span : spans) {
    const auto intervals =
        std::clamp(static_cast<size_t>((span.last_s - span.first_s) / knot_distance_s),
                   fewest_intervals, most_intervals);
    span.intervals = 2 * static_cast<Eigen::Index>(intervals);
    span.first_column = column;
    column += 3 * span.knots();
  }
  return spans;
}

// Normal equations of the shared columns and the biases at all knots.
struct Equations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
};

// Removes outliers.
void drop_bias_outliers(std::vector<double>& values) {
  constexpr double far = 9.0;  // of the median distance from zero: six standard deviations of noise
  std::vector<double> distances;
  for (const double x : values) {
    if (std::isfinite(x)) distances.push_back(std::abs(x));
  }
  if (distances.empty()) return;
  const double usual = upper_median(std::move(distances));
  for (double& x : values) {
    if (std::abs(x) > far * usual) x = NAN;
  }
}

// Whether the rotation between two blocks is small enough for the linear model.
bool turns_slowly(const Observation& seen) {
  const double apart_s =
      std::max(seen.row_interval_s,
               seen.duration_s() / static_cast<double>(std::max<size_t>(1, seen.blocks() - 1)));
  return median_gyro_rate_rad_s(seen) * apart_s < most_turn_rad;
}

size_t blocks_of(const Observation& seen) {
  const double turns = median_gyro_rate_rad_s(seen) * seen.duration_s() / most_turn_rad;
  return static_cast<size_t>(std::max(usual_blocks, turns));
}

void add_piece(const Observation& seen, const Span& span, Equations& sums) {
  const KinematicRun run = kinematic_run(seen.averaged(blocks_of(seen)), nullptr);
  const Eigen::Index own = 3 * span.knots(), columns = shared_count + own;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(columns, columns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(columns);
  for (int k = 0; k < 3; ++k) {
    KinematicSeries series = run.axis[static_cast<size_t>(k)];
    const KinematicSeries& all = run.axis[static_cast<size_t>(k)];
    const auto rows = static_cast<Eigen::Index>(series.blocks());
    series.angle_by.setZero(rows, columns);
    series.rate_by.setZero(rows, columns);
    for (Eigen::Index row = 0; row < rows; ++row) {
      for (Eigen::Index c = 0; c < shared_count; ++c) {
        series.angle_by(row, c) = all.angle_by(row, shared_columns[static_cast<size_t>(c)]);
        series.rate_by(row, c) = all.rate_by(row, shared_columns[static_cast<size_t>(c)]);
      }
      const auto [knot, part] = span.place(series.time_s[static_cast<size_t>(row)]);
      const auto bias = all.rate_by.block<1, 3>(row, 0);
      series.rate_by.block<1, 3>(row, shared_count + 3 * knot) = (1.0 - part) * bias;
      series.rate_by.block<1, 3>(row, shared_count + 3 * (knot + 1)) = part * bias;
    }
    drop_bias_outliers(series.angle_rad);
    drop_bias_outliers(series.rate_rad_s);
    AngleNoise noise;
    noise.camera = seen.noise.of(k);
    noise.gyro_rad_s = seen.noise.levels(3);
    noise.roughness = any_roughness;
    add_normal_equations(series, noise, matrix, right);
  }
  const auto scatter = [&](Eigen::Index c) {
    return c < shared_count ? c : span.first_column + c - shared_count;
  };
  for (Eigen::Index i = 0; i < columns; ++i) {
    sums.right[scatter(i)] += right[i];
    for (Eigen::Index j = 0; j < columns; ++j) sums.matrix(scatter(i), scatter(j)) += matrix(i, j);
  }
}

Equations equations_of(const std::vector<Span>& spans) {
  const Eigen::Index size = spans.back().first_column + 3 * spans.back().knots();
  Equations sums{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  for (const Span& span : spans) {
    for (const Observation* piece : span.pieces) add_piece(*piece, span, sums);
  }
  return sums;
}

// Scale and misalignment of a gyro: its nine numbers, by rows, are the first shared columns.
constexpr Eigen::Index of_matrix = 9;
constexpr std::array<Eigen::Index, 3> scales = {0, 4, 8};
// The usual error of each, and the largest error that is attributed to the scale of a gyro.
constexpr double usual_matrix_error = 0.01, most_scale_error = 0.3;

// Adds priors to the parameters that all recordings have in common: scale and misalignment, with
// the widths `matrix_errors`, camera delay and rotation of the laboratory. If the motion does not
// separate these from a bias, the difference is attributed to the bias.
Equations with_priors(Equations sums, const Eigen::VectorXd& matrix_errors) {
  Eigen::VectorXd widths = Eigen::VectorXd::Constant(sums.right.size(), 0.1);
  widths.head<shared_count>() << matrix_errors, 0.05, Vec3::Constant(7e-5);
  sums.matrix.diagonal() += widths.cwiseAbs2().cwiseInverse();
  return sums;
}

// A model of the biases at all knots; each column of its basis belongs to one parameter.
enum class Bias { constant, lines, finer };

Eigen::MatrixXd basis_of(Bias model, const std::vector<Span>& spans, Eigen::Index size) {
  std::vector<Eigen::VectorXd> columns;
  for (Eigen::Index c = 0; c < shared_count; ++c) {
    columns.push_back(Eigen::VectorXd::Unit(size, c));
  }
  for (const Span& span : spans) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto at = [&](Eigen::Index knot) { return span.first_column + 3 * knot + axis; };
      Eigen::VectorXd constant = Eigen::VectorXd::Zero(size);
      for (Eigen::Index k = 0; k < span.knots(); ++k) {
        constant[at(k)] = 1.0;
        if (model == Bias::constant || (model == Bias::lines && k % 2 == 1)) continue;
        Eigen::VectorXd hat = Eigen::VectorXd::Unit(size, at(k));
        if (model == Bias::lines && k > 0) hat[at(k - 1)] = 0.5;
        if (model == Bias::lines && k < span.intervals) hat[at(k + 1)] = 0.5;
        columns.push_back(std::move(hat));
      }
      if (model == Bias::constant) columns.push_back(std::move(constant));
    }
  }
  Eigen::MatrixXd basis(size, static_cast<Eigen::Index>(columns.size()));
  for (size_t c = 0; c < columns.size(); ++c) basis.col(static_cast<Eigen::Index>(c)) = columns[c];
  return basis;
}

// The least-squares solution of a model.
struct Solution {
  Eigen::MatrixXd basis;
  Eigen::LDLT<Eigen::MatrixXd> solver;
  Eigen::VectorXd numbers;
  double gain = 0.0;  // decrease of χ²

  double count() const { return static_cast<double>(numbers.size()); }
  // The bias at a knot minus the mean of all knots, and its standard error.
  double from_mean(const Span& span, Eigen::Index knot, Eigen::Index axis) const {
    return combination(span, knot, axis).dot(numbers);
  }
  double sigma_from_mean(const Span& span, Eigen::Index knot, Eigen::Index axis) const {
    const Eigen::VectorXd of = combination(span, knot, axis);
    return std::sqrt(std::max(0.0, of.dot(solver.solve(of))));
  }

 private:
  Eigen::VectorXd combination(const Span& span, Eigen::Index knot, Eigen::Index axis) const {
    Eigen::VectorXd of = Eigen::VectorXd::Zero(basis.rows());
    for (Eigen::Index k = 0; k < span.knots(); ++k) {
      of[span.first_column + 3 * k + axis] = -1.0 / static_cast<double>(span.knots());
    }
    of[span.first_column + 3 * knot + axis] += 1.0;
    return basis.transpose() * of;
  }
};

Solution solved(Bias model, const std::vector<Span>& spans, const Equations& sums) {
  Solution s;
  s.basis = basis_of(model, spans, sums.right.size());
  const Eigen::VectorXd right = s.basis.transpose() * sums.right;
  s.solver.compute(s.basis.transpose() * sums.matrix * s.basis);
  s.numbers = s.solver.solve(right);
  s.gain = right.dot(s.numbers);
  return s;
}

// Standard deviations of the scale and misalignment of a gyro. A scale gets a wider prior if the
// motion determines a large error independently of the bias; with the usual prior it would appear
// as a drift. Misalignments keep the usual prior, because the linear model explains large ones only
// in part.
Eigen::VectorXd matrix_errors(const std::vector<Span>& spans, const Equations& sums) {
  constexpr double clear_sigma = 3.0;
  const Solution free =
      solved(Bias::lines, spans,
             with_priors(sums, Eigen::VectorXd::Constant(of_matrix, most_scale_error)));
  Eigen::VectorXd errors = Eigen::VectorXd::Constant(of_matrix, usual_matrix_error);
  for (const Eigen::Index k : scales) {
    const double found = std::abs(free.numbers[k]);
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(free.numbers.size(), k);
    const double sigma = std::sqrt(std::max(0.0, unit.dot(free.solver.solve(unit))));
    const bool is_clear = found > 3.0 * usual_matrix_error && found > clear_sigma * sigma;
    if (is_clear && found < most_scale_error) errors[k] = found;
  }
  return errors;
}

// The history at every second knot. `wider` is the ratio of the noise to the stated noise.
BiasHistory history_of(const Span& span, const Solution& s, double wider) {
  BiasHistory history{span.name, {}, {}, {}};
  for (Eigen::Index k = 0; k < span.knots(); k += 2) {
    Vec3 bias, sigma;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      bias[axis] = s.from_mean(span, k, axis);
      sigma[axis] = wider * s.sigma_from_mean(span, k, axis);
    }
    history.time_s.push_back(span.knot_s(k));
    history.bias_rad_s.push_back(bias);
    history.sigma_rad_s.push_back(sigma);
  }
  return history;
}

}  // namespace

Vec3 BiasHistory::at(double t_s) const {
  const auto next =
      static_cast<size_t>(std::upper_bound(time_s.begin(), time_s.end(), t_s) - time_s.begin());
  if (next == 0) return bias_rad_s.front();
  if (next == time_s.size()) return bias_rad_s.back();
  const double part = (t_s - time_s[next - 1]) / (time_s[next] - time_s[next - 1]);
  return (1.0 - part) * bias_rad_s[next - 1] + part * bias_rad_s[next];
}

std::vector<BiasHistory> bias_histories(const std::vector<const Observation*>& pieces) {
  const auto is_complete = [](const Observation* seen) {
    return seen->has_gyro && seen->sees_attitude() && turns_slowly(*seen);
  };
  if (pieces.empty() || !std::all_of(pieces.begin(), pieces.end(), is_complete)) return {};
  const std::vector<Span> spans = spans_of(pieces);
  const Equations seen = equations_of(spans);
  if (!seen.matrix.allFinite() || !seen.right.allFinite()) return {};
  const Equations sums = with_priors(seen, matrix_errors(spans, seen));
  const Solution constant = solved(Bias::constant, spans, sums),
                 lines = solved(Bias::lines, spans, sums), finer = solved(Bias::finer, spans, sums);
  // Noise that is correlated or above the stated level decreases χ² by more than one per parameter.
  // This is measured by the odd knots, which a bias does not need.
  const double by_noise =
      std::max(1.0, (finer.gain - lines.gain) / (finer.count() - lines.count()));
  const double more = lines.count() - constant.count();
  std::vector<BiasHistory> histories;
  if (!((lines.gain - constant.gain) / by_noise > least_gain + 2.0 * more)) return histories;
  for (const Span& span : spans) {
    histories.push_back(history_of(span, lines, std::sqrt(by_noise)));
  }
  return histories;
}

}  // namespace photorque
