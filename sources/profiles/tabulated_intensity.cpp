#include "sources/profiles/tabulated_intensity.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/constants.h"
#include "core/numerics/interpolation.h"
#include "core/numerics/quadrature.h"
#include "core/numerics/vector_math.h"

namespace photorque {
namespace {

// Axes of the table's frame in the emitter's frame: z is the pole, and the azimuth counts from x.
Mat3 emitter_from_pole(Pole pole) {
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  Mat3 axes;
  if (pole == Pole::beam) {
    axes << x, -y, z;
  } else if (pole == Pole::vertical) {
    axes << z, y, x;  // azimuth from the beam towards +y
  } else {
    axes << z, x, y;  // azimuth from the beam towards +x
  }
  return axes;
}

}  // namespace

GoniometerAngles table_angles(Pole pole, const Vec3& direction) {
  const Vec3 d = emitter_from_pole(pole).transpose() * direction;
  return {std::atan2(std::hypot(d.x(), d.y()), d.z()), std::atan2(d.y(), d.x())};
}

TabulatedIntensity::TabulatedIntensity(IntensityTable table) : table_(std::move(table)) {
  largest_ = *std::max_element(table_.intensity.begin(), table_.intensity.end());
  find_knots();
  for (size_t j = 0; j < table_.planes(); ++j) {
    const size_t first = j * knot_rad_.size();
    samplers_.emplace_back(knot_rad_, &value_[first], &slope_[first]);
  }
  find_hat_functions();
}

double TabulatedIntensity::between_planes(size_t angle, double azimuth_rad) const {
  const size_t planes = table_.planes();
  for (size_t j = 0; j < planes; ++j) {
    const size_t next = (j + 1) % planes;
    const double gap = next > j ? table_.azimuth_rad[next] - table_.azimuth_rad[j]
                                : table_.azimuth_rad[next] + 2.0 * pi - table_.azimuth_rad[j];
    const double turns = (azimuth_rad - table_.azimuth_rad[j]) / (2.0 * pi);
    const double ahead = 2.0 * pi * (turns - std::floor(turns));
    if (ahead <= gap) {
      return std::lerp(table_.plane(j)[angle], table_.plane(next)[angle], ahead / gap);
    }
  }
  return table_.plane(0)[angle];
}

void TabulatedIntensity::find_knots() {
  const std::vector<double>& polar = table_.polar_rad;
  const size_t angles = polar.size();
  // Across a pole the curve continues in the opposite plane. The number of its angles added here is
  // the range of the polynomials.
  const size_t beyond = std::min<size_t>(3, angles - 1);
  const size_t before = table_.closed && polar.front() == 0.0 ? beyond : 0;
  const size_t after = table_.closed && polar.back() == pi ? beyond : 0;
  for (size_t j = 0; j < table_.planes(); ++j) {
    const double opposite_rad = table_.azimuth_rad[j] + pi;
    std::vector<double> x, y;
    for (size_t k = before; k > 0; --k) {
      x.push_back(-polar[k]);
      y.push_back(between_planes(k, opposite_rad));
    }
    x.insert(x.end(), polar.begin(), polar.end());
    y.insert(y.end(), table_.plane(j), table_.plane(j) + angles);
    for (size_t k = angles - 1; k > angles - 1 - after; --k) {
      x.push_back(2.0 * pi - polar[k - 1]);
      y.push_back(between_planes(k - 1, opposite_rad));
    }
    std::vector<double> fine_x, fine_y;
    for (size_t k = 0; k + 1 < x.size(); ++k) {
      fine_x.insert(fine_x.end(), {x[k], 0.5 * (x[k] + x[k + 1])});
      fine_y.insert(fine_y.end(), {y[k], monotone_middle(x, y, k)});
    }
    fine_x.push_back(x.back());
    fine_y.push_back(y.back());
    const std::vector<double> slopes = monotone_slopes(fine_x, fine_y);
    const auto from = static_cast<std::ptrdiff_t>(2 * before);
    const auto to = from + static_cast<std::ptrdiff_t>(2 * angles - 1);
    if (j == 0) knot_rad_.assign(fine_x.begin() + from, fine_x.begin() + to);
    value_.insert(value_.end(), fine_y.begin() + from, fine_y.begin() + to);
    slope_.insert(slope_.end(), slopes.begin() + from, slopes.begin() + to);
  }
}

void TabulatedIntensity::find_hat_functions() {
  const std::vector<double>& azimuth = table_.azimuth_rad;
  const size_t planes = azimuth.size(), knots = knot_rad_.size();
  mean_.assign(knots, 0.0);
  mean_slope_.assign(knots, 0.0);
  for (size_t j = 0; j < planes; ++j) {
    Hat hat{0.0, 0.0, azimuth[j], 0.0, 0.0};
    if (planes == 1) {
      hat.below_rad = hat.above_rad = 2.0 * pi;
    } else {
      const bool first = j == 0, last = j + 1 == planes;
      if (!first) hat.below_rad = azimuth[j] - azimuth[j - 1];
      if (!last) hat.above_rad = azimuth[j + 1] - azimuth[j];
      const double across = azimuth.front() + 2.0 * pi - azimuth.back();
      if (first && table_.closed) hat.below_rad = across;
      if (last && table_.closed) hat.above_rad = across;
    }
    const double area_rad = 0.5 * (hat.below_rad + hat.above_rad);
    hat.fraction = area_rad * samplers_[j].flux();
    flux_ += hat.fraction;
    for (size_t k = 0; k < knots; ++k) {
      mean_[k] += area_rad / (2.0 * pi) * value_[j * knots + k];
      mean_slope_[k] += area_rad / (2.0 * pi) * slope_[j * knots + k];
    }
    hats_.push_back(hat);
  }
  double before = 0.0;
  for (Hat& hat : hats_) {
    hat.before = before;
    hat.fraction /= flux_;
    before += hat.fraction;
  }
}

double TabulatedIntensity::curve(const double* value, const double* slope, double polar_rad) const {
  if (!(polar_rad >= knot_rad_.front() && polar_rad <= knot_rad_.back())) return 0.0;
  const auto above = std::upper_bound(knot_rad_.begin() + 1, knot_rad_.end() - 1, polar_rad);
  const auto i = static_cast<size_t>(above - knot_rad_.begin()) - 1;
  const double width = knot_rad_[i + 1] - knot_rad_[i];
  return std::max(0.0, hermite(width, value[i], slope[i], value[i + 1], slope[i + 1],
                               (polar_rad - knot_rad_[i]) / width));
}

double TabulatedIntensity::plane_at(size_t plane, double polar_rad) const {
  const size_t first = plane * knot_rad_.size();
  return curve(&value_[first], &slope_[first], polar_rad);
}

double TabulatedIntensity::mean(double polar_rad) const {
  return curve(mean_.data(), mean_slope_.data(), polar_rad);
}

double TabulatedIntensity::at(double polar_rad, double azimuth_rad) const {
  if (table_.planes() == 1) return plane_at(0, polar_rad);
  const std::vector<double>& azimuth = table_.azimuth_rad;
  double turned = azimuth_rad - azimuth.front();
  if (table_.closed) turned -= 2.0 * pi * std::floor(turned / (2.0 * pi));
  const double sought = azimuth.front() + turned;
  if (!table_.closed && !(sought >= azimuth.front() && sought <= azimuth.back())) return 0.0;
  const auto above = std::upper_bound(azimuth.begin() + 1, azimuth.end(), sought);
  const auto j = std::min(static_cast<size_t>(above - azimuth.begin()) - 1,
                          azimuth.size() - (table_.closed ? 1 : 2));
  return std::lerp(plane_at(j, polar_rad), plane_at((j + 1) % azimuth.size(), polar_rad),
                   (sought - azimuth[j]) / hats_[j].above_rad);
}

void TabulatedIntensity::directions(const FractionBlock& polar, const FractionBlock& azimuth,
                                    VectorBlock& direction) const {
  const Pole pole = table_.pole;
  for (int i = 0; i < ray_block; ++i) {
    const double turn = fraction_of(azimuth[i]);
    size_t j = 0;
    double azimuth_rad = 2.0 * pi * turn;
    if (hats_.size() > 1) {
      const auto after =
          std::upper_bound(hats_.begin() + 1, hats_.end(), turn,
                           [](double fraction, const Hat& hat) { return fraction < hat.before; });
      j = static_cast<size_t>(after - hats_.begin()) - 1;
      while (samplers_[j].flux() <= 0.0) j = j > 0 ? j - 1 : hats_.size() - 1;
      const Hat& hat = hats_[j];
      const double part = std::clamp((turn - hat.before) / hat.fraction, 0.0, 1.0);
      const double below = hat.below_rad / (hat.below_rad + hat.above_rad);
      azimuth_rad =
          part < below
              ? hat.centre_rad - hat.below_rad * (1.0 - std::sqrt(part / below))
              : hat.centre_rad + hat.above_rad * (1.0 - std::sqrt((1.0 - part) / (1.0 - below)));
    }
    const double rise = samplers_[j].rise(fraction_of(polar[i]));
    const double sine = std::sqrt(std::max(0.0, rise * (2.0 - rise)));
    const double c = sine * std::cos(azimuth_rad), s = sine * std::sin(azimuth_rad);
    const double along = 1.0 - rise;
    const bool beam = pole == Pole::beam, vertical = pole == Pole::vertical;
    direction[0][i] = beam ? c : vertical ? along : s;
    direction[1][i] = beam ? -s : vertical ? s : along;
    direction[2][i] = beam ? along : c;
  }
}

TabulatedIntensity::Coarseness TabulatedIntensity::coarseness() const {
  const std::vector<double>& polar = table_.polar_rad;
  double straight = 0.0, zonal = 0.0;
  for (size_t i = 0; i + 1 < polar.size(); ++i) {
    const double low = mean_[2 * i], high = mean_[2 * i + 2];  // every second knot is an angle
    const double middle_rad = knot_rad_[2 * i + 1];
    straight += integrate(
        gauss_8,
        [&](double t) {
          return std::sin(t) * std::lerp(low, high, (t - polar[i]) / (polar[i + 1] - polar[i]));
        },
        polar[i], polar[i + 1]);
    zonal += low * (rise_at(middle_rad) - rise_at(polar[i])) +
             high * (rise_at(polar[i + 1]) - rise_at(middle_rad));
  }
  return {2.0 * pi * straight / flux_ - 1.0, 2.0 * pi * zonal / flux_ - 1.0};
}

}  // namespace photorque
