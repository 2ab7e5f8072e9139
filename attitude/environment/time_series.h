// A vector that is known at some times and interpolated smoothly between them.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/numerics/dual.h"
#include "core/transform.h"

namespace photorque {

// A natural cubic spline through samples. It is twice continuously differentiable, so that an
// integrator can take steps longer than the sampling interval. Before the first and after the last
// sample the value is that of the end ("hold") or zero.
class TimeSeries {
 public:
  enum class Outside { hold, zero };

  // NumericalError unless there are at least two samples, all finite, with strictly increasing
  // times.
  TimeSeries(std::vector<double> times_s, const std::vector<Vec3>& values,
             Outside outside = Outside::hold);

  // The first and the last time, at which the series is not smooth.
  std::array<double, 2> ends_s() const { return {times_s_.front(), times_s_.back()}; }

  // Value and time derivative of one component.
  std::array<double, 2> at(double time_s, int component) const;
  Vec3 at(double time_s) const;

  template <class T>
  Vec3Of<T> sample(const T& time_s) const {
    Vec3Of<T> v;
    for (int k = 0; k < 3; ++k) {
      v[k] = from_values(time_s, [&](double t_s) { return at(t_s, k); });
    }
    return v;
  }

 private:
  std::vector<double> times_s_;
  std::array<std::vector<double>, 3> value_;
  std::array<std::vector<double>, 3> curvature_;  // second derivatives at the samples
  Outside outside_;
};

// Reads a CSV whose header contains a time column `t_s` and the three `columns`, in any order and
// among others. InputError with the line of a cell that is missing, not a number or not in order of
// time.
TimeSeries read_time_series(const std::filesystem::path& path,
                            const std::array<std::string, 3>& columns,
                            TimeSeries::Outside outside = TimeSeries::Outside::hold);

}  // namespace photorque
