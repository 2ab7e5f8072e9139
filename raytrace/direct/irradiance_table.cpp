#include "raytrace/direct/irradiance_table.h"

#include <algorithm>
#include <cmath>

#include "core/numerics/interpolation.h"
#include "core/parallel.h"

namespace photorque {
namespace {

constexpr double negligible = 1e-8;

// Number of terms of a series in height whose terms fall by `ratio` each, at most 8.
size_t degrees_for(double ratio) {
  constexpr size_t most = 8;
  if (ratio < 1e-9) return 1;
  const double wanted = 1.0 + std::log(negligible) / std::log(std::min(ratio, 0.5));
  return std::min(static_cast<size_t>(wanted) + 1, most);
}

// Matrix of n columns. Row i gives the value at the i-th of `count` equally spaced places of [0, 1]
// (both ends included) of the polynomial through values at n Chebyshev points, which rise.
Eigen::MatrixXd values_at_even_places(size_t n, size_t count) {
  const auto places = static_cast<Eigen::Index>(count), terms = static_cast<Eigen::Index>(n);
  Eigen::MatrixXd term(places, terms);
  for (Eigen::Index i = 0; i < places; ++i) {
    const double x = count > 1 ? 2.0 * static_cast<double>(i) / (count - 1.0) - 1.0 : 0.0;
    term(i, 0) = 1.0;
    if (terms > 1) term(i, 1) = x;
    for (Eigen::Index k = 2; k < terms; ++k) term(i, k) = 2.0 * x * term(i, k - 1) - term(i, k - 2);
  }
  return term * chebyshev_coefficients(n);
}

}  // namespace

template <int Count>
class FactorTable<Count>::Series {
 public:
  // Doubles the number of Chebyshev points in the root until the series converges; empty if it
  // needs more than 96 points.
  static std::optional<Series> of(const FactorTable& table, const DiscLight& light, int threads) {
    constexpr size_t fewest = 24, most = 96;
    const size_t degrees =
        degrees_for((table.high_m_ - table.low_m_) / (table.high_m_ + table.low_m_));
    for (size_t points = fewest; points <= most; points *= 2) {
      const Series one(table, light, points, 1, threads);
      if (!one.converged()) continue;
      if (degrees == 1) return one;
      return Series(table, light, points, degrees, threads);
    }
    return std::nullopt;
  }

  // Values of one factor on one half of a piece, at equal steps and heights.
  Eigen::MatrixXd values(size_t half, size_t factor, const Eigen::MatrixXd& at_steps,
                         const Eigen::MatrixXd& at_rows) const {
    return at_steps * value_[half * Count + factor] * at_rows.transpose();
  }
  size_t points() const { return points_; }
  size_t degrees() const { return degrees_; }

 private:
  Series(const FactorTable& table, const DiscLight& light, size_t points, size_t degrees,
         int threads)
      : points_(points),
        degrees_(degrees),
        value_(table.halves() * Count, Eigen::MatrixXd(static_cast<Eigen::Index>(points),
                                                       static_cast<Eigen::Index>(degrees))) {
    parallel_for(table.halves() * points * degrees, threads, [&](size_t n) {
      const size_t half = n / (points * degrees), i = n / degrees % points, j = n % degrees;
      const double h =
          table.low_m_ + chebyshev_fraction(degrees, j) * (table.high_m_ - table.low_m_);
      const Factors here =
          factors_of(light, table.distance_m(half, chebyshev_fraction(points, i), h), h);
      for (size_t f = 0; f < Count; ++f) {
        value_[half * Count + f](static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            here[static_cast<Eigen::Index>(f)];
      }
    });
  }

  // Whether the last terms of the series in the root are negligible, at the first height.
  bool converged() const {
    const Eigen::MatrixXd last = chebyshev_coefficients(points_).bottomRows(3);
    double largest = 0.0, left = 0.0;
    for (const Eigen::MatrixXd& value : value_) {
      largest = std::max(largest, value.cwiseAbs().maxCoeff());
      left = std::max(left, (last * value.col(0)).cwiseAbs().maxCoeff());
    }
    return left <= negligible * largest;
  }

  size_t points_, degrees_;
  std::vector<Eigen::MatrixXd> value_;  // [half · Count + factor]: points of the root by heights
};

// Edges of the beam in rising order. Empty if they cross within the range of heights, or if the
// light extends too far to the side.
template <int Count>
std::optional<std::vector<typename FactorTable<Count>::Kink>> FactorTable<Count>::kinks_of(
    const DiscLight& light, double low_m, double high_m) {
  if (light.parallel() || light.collimated() || !(low_m > 0.0)) return std::nullopt;
  const std::vector<double>& slopes = light.angles().edge_slopes();
  const double radius_m = light.radius_m(), last_slope = slopes.back();
  if (!(last_slope < 10.0)) return std::nullopt;
  std::vector<Kink> kinks = {{0.0, 0.0}, {radius_m, last_slope}};
  if (!light.fades_out()) {
    for (const double slope : slopes) {
      const double sign = radius_m > slope * low_m ? 1.0 : -1.0;
      kinks.push_back({sign * radius_m, -sign * slope});
      if (slope < last_slope) kinks.push_back({radius_m, slope});
    }
  }
  const double middle_m = 0.5 * (low_m + high_m);
  std::sort(kinks.begin(), kinks.end(),
            [&](const Kink& a, const Kink& b) { return a.at(middle_m) < b.at(middle_m); });
  for (size_t k = 1; k < kinks.size(); ++k) {
    for (const double height_m : {low_m, high_m}) {
      const double min_m = 1e-6 * kinks.back().at(height_m);
      if (!(kinks[k].at(height_m) - kinks[k - 1].at(height_m) > min_m)) return std::nullopt;
    }
  }
  return kinks;
}

template <int Count>
std::optional<FactorTable<Count>> FactorTable<Count>::make(const DiscLight& light, double low_m,
                                                           double high_m, int threads) {
  constexpr size_t fewest_steps = 256, most_steps = 512, fewest_rows = 24;
  auto kinks = kinks_of(light, low_m, high_m);
  if (!kinks) return std::nullopt;
  FactorTable table(low_m, high_m, *std::move(kinks));
  const auto series = Series::of(table, light, threads);
  if (!series) return std::nullopt;
  size_t rows = fewest_rows;
  for (size_t steps = fewest_steps; steps <= most_steps; steps *= 2, rows *= 2) {
    table.fill(*series, steps, series->degrees() == 1 ? 1 : rows + 1);
    if (table.agrees_with(light)) return table;
  }
  return std::nullopt;
}

template <int Count>
double FactorTable<Count>::distance_m(size_t half, double fraction, double height_m) const {
  const double from = kinks_[half / 2].at(height_m), to = kinks_[half / 2 + 1].at(height_m);
  const double part = 0.5 * fraction * fraction;
  return half % 2 == 0 ? from + part * (to - from) : to - part * (to - from);
}

template <int Count>
void FactorTable<Count>::fill(const Series& series, size_t steps, size_t rows) {
  steps_ = steps;
  rows_ = rows;
  rows_per_m_ = (static_cast<double>(rows) - 1.0) / (high_m_ - low_m_);
  values_.assign(halves() * rows * (steps + 1) * Count, 0.0);
  const Eigen::MatrixXd at_steps = values_at_even_places(series.points(), steps + 1);
  const Eigen::MatrixXd at_rows = values_at_even_places(series.degrees(), rows);
  for (size_t half = 0; half < halves(); ++half) {
    double* first = &values_[half * rows * (steps + 1) * Count];
    for (size_t f = 0; f < Count; ++f) {
      Eigen::Map<Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, Count>>(
          first + f, static_cast<Eigen::Index>(steps + 1), static_cast<Eigen::Index>(rows),
          {static_cast<Eigen::Index>(Count * (steps + 1)), Count}) =
          series.values(half, f, at_steps, at_rows);
    }
  }
}

template <int Count>
bool FactorTable<Count>::agrees_with(const DiscLight& light) {
  constexpr size_t tests = 19;  // per half
  double largest = 0.0, worst = 0.0;
  // Tests the middle of the first interval of heights, where the cubic is least accurate, and the
  // middle of one more interval.
  const size_t intervals = std::max<size_t>(rows_ - 1, 1);
  for (const size_t interval : {size_t{0}, 2 * intervals / 3}) {
    const double h = low_m_ + (static_cast<double>(interval) + 0.5) /
                                  static_cast<double>(intervals) * (high_m_ - low_m_);
    for (size_t half = 0; half < halves(); ++half) {
      for (size_t test = 0; test < tests; ++test) {
        const double step = static_cast<double>(test * steps_ / tests) + 0.5;
        const double d = distance_m(half, step / static_cast<double>(steps_), h);
        const Factors truth = factors_of(light, d, h);
        largest = std::max(largest, truth[0]);
        worst = std::max(worst, (at(d, h) - truth).abs().maxCoeff());
      }
    }
  }
  error_ = worst;
  return worst <= tolerance * largest;
}

template class FactorTable<2>;
template class FactorTable<6>;

}  // namespace photorque
