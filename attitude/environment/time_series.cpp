#include "attitude/environment/time_series.h"

#include <algorithm>
#include <cmath>

#include "core/text/parse.h"

namespace photorque {
namespace {

// Second derivatives of the natural spline: a tridiagonal system, solved by elimination and back
// substitution.
std::vector<double> spline_curvatures(const std::vector<double>& x, const std::vector<double>& y) {
  const size_t n = x.size();
  std::vector<double> curvature(n, 0.0), upper(n, 0.0);
  for (size_t i = 1; i + 1 < n; ++i) {
    const double before = x[i] - x[i - 1], after = x[i + 1] - x[i];
    const double jump = 6.0 * ((y[i + 1] - y[i]) / after - (y[i] - y[i - 1]) / before);
    const double pivot = 2.0 * (before + after) - before * upper[i - 1];
    upper[i] = after / pivot;
    curvature[i] = (jump - before * curvature[i - 1]) / pivot;
  }
  for (size_t i = n - 1; i-- > 1;) curvature[i] -= upper[i] * curvature[i + 1];
  return curvature;
}

}  // namespace

TimeSeries::TimeSeries(std::vector<double> times_s, const std::vector<Vec3>& values,
                       Outside outside)
    : times_s_(std::move(times_s)), outside_(outside) {
  bool good = times_s_.size() >= 2 && values.size() == times_s_.size();
  for (size_t i = 0; good && i < values.size(); ++i) {
    good = values[i].allFinite() && std::isfinite(times_s_[i]) &&
           (i == 0 || times_s_[i] > times_s_[i - 1]);
  }
  if (!good) {
    throw NumericalError("time series: at least two finite samples in rising order of time needed");
  }
  for (int k = 0; k < 3; ++k) {
    for (const Vec3& v : values) value_[k].push_back(v[k]);
    curvature_[k] = spline_curvatures(times_s_, value_[k]);
  }
}

std::array<double, 2> TimeSeries::at(double time_s, int component) const {
  const std::vector<double>& y = value_[component];
  const std::vector<double>& c = curvature_[component];
  const auto [first_s, last_s] = ends_s();
  if (time_s < first_s || time_s > last_s) {
    if (outside_ == Outside::zero) return {0.0, 0.0};
    return {time_s < first_s ? y.front() : y.back(), 0.0};
  }
  const auto after = std::upper_bound(times_s_.begin(), times_s_.end() - 1, time_s);
  const size_t i = static_cast<size_t>(after - times_s_.begin()) - 1;
  const double h = times_s_[i + 1] - times_s_[i];
  const double b = (time_s - times_s_[i]) / h, a = 1.0 - b;
  return {
      a * y[i] + b * y[i + 1] + ((a * a * a - a) * c[i] + (b * b * b - b) * c[i + 1]) * h * h / 6.0,
      (y[i + 1] - y[i]) / h +
          ((3.0 * b * b - 1.0) * c[i + 1] - (3.0 * a * a - 1.0) * c[i]) * h / 6.0};
}

Vec3 TimeSeries::at(double time_s) const {
  return {at(time_s, 0)[0], at(time_s, 1)[0], at(time_s, 2)[0]};
}

TimeSeries read_time_series(const std::filesystem::path& path,
                            const std::array<std::string, 3>& columns,
                            TimeSeries::Outside outside) {
  const NumberColumns file = read_number_columns(path, {"t_s", columns[0], columns[1], columns[2]});
  const std::vector<double>& times_s = file.columns[0];
  std::vector<Vec3> values;
  for (size_t i = 0; i < times_s.size(); ++i) {
    if (i > 0 && !(times_s[i] > times_s[i - 1])) {
      throw InputError({path.string(), file.lines[i]}, "t_s", std::to_string(times_s[i]),
                       "times in rising order");
    }
    values.emplace_back(file.columns[1][i], file.columns[2][i], file.columns[3][i]);
  }
  if (times_s.size() < 2) {
    throw InputError({path.string()}, "", std::to_string(times_s.size()) + " rows",
                     "at least 2 rows");
  }
  return TimeSeries(times_s, values, outside);
}

}  // namespace photorque
