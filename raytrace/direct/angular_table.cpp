#include "raytrace/direct/angular_table.h"

#include <limits>
#include <utility>

#include "core/constants.h"

namespace photorque {
namespace {

constexpr size_t segment_steps = 4096;

double rise_of(double angle_rad) {
  const double sine = std::sin(0.5 * angle_rad);
  return 2.0 * sine * sine;
}

double angle_of(double rise) {
  return 2.0 * std::asin(std::sqrt(std::clamp(0.5 * rise, 0.0, 1.0)));
}

// Integral over step i, in units of one step, of the cubic through the nearest four values at equal
// steps.
double step_integral(const std::vector<double>& v, size_t i) {
  const size_t last = v.size() - 1;
  const auto at_end = [&](size_t a, size_t b, size_t c, size_t d) {
    return (9.0 * v[a] + 19.0 * v[b] - 5.0 * v[c] + v[d]) / 24.0;
  };
  if (i == 0) return at_end(0, 1, 2, 3);
  if (i + 1 == last) return at_end(last, last - 1, last - 2, last - 3);
  return (13.0 * (v[i] + v[i + 1]) - v[i - 1] - v[i + 2]) / 24.0;
}

}  // namespace

AngularTable::AngularTable(const Emitter& emitter, const std::vector<double>& edges_rad) {
  constexpr int most_splits = 6;
  double low_rad = 0.0;
  std::vector<size_t> ends;  // index of the last segment before each edge
  for (const double high_rad : edges_rad) {
    add_segment(emitter, low_rad, high_rad, most_splits);
    ends.push_back(segments_.size() - 1);
    low_rad = high_rad;
  }
  double jump = segments_.back().value.back();
  for (const size_t s : std::span(ends).first(ends.size() - 1)) {
    jump = std::max(jump, std::abs(segments_[s].value.back() - segments_[s + 1].value.front()));
  }
  fades_out_ = jump < 1e-9 * segments_.front().value.front();
  normalise();
  find_angles(edges_rad);
}

// Tabulates the intensity between two angles. Halves the interval, at most `splits` times, until
// the interpolated intensity agrees with the emitter's.
void AngularTable::add_segment(const Emitter& emitter, double low_rad, double high_rad,
                               int splits) {
  // Stays off the edges, because a profile may jump exactly there.
  constexpr double inside = 1.0 - 1e-14;
  constexpr double tolerance = 1e-7;
  constexpr size_t stride = 17;  // tests the interpolation in every 17th interval
  const auto intensity = [&](double rise) {
    const double within = std::clamp(angle_of(rise), low_rad * (2.0 - inside), high_rad * inside);
    return emitter.relative_intensity(within);
  };
  Segment segment{rise_of(low_rad), rise_of(high_rad), 0.0, {}, {}};
  const double step = (segment.high - segment.low) / static_cast<double>(segment_steps);
  segment.per_step = 1.0 / step;
  double largest = 0.0, worst = 0.0;
  for (size_t i = 0; i <= segment_steps; ++i) {
    segment.value.push_back(intensity(segment.low + step * static_cast<double>(i)));
    largest = std::max(largest, segment.value.back());
  }
  for (size_t i = 0; i < segment_steps; i += stride) {
    const double rise = segment.low + step * (static_cast<double>(i) + 0.5);
    worst = std::max(worst, std::abs(segment.intensity(rise) - intensity(rise)));
  }
  if (worst > tolerance * largest && splits > 0) {
    const double middle_rad = 0.5 * (low_rad + high_rad);
    add_segment(emitter, low_rad, middle_rad, splits - 1);
    add_segment(emitter, middle_rad, high_rad, splits - 1);
    return;
  }
  segments_.push_back(std::move(segment));
}

// Normalises the total flux to 1 and fills the cumulative flux, starting at the axis.
void AngularTable::normalise() {
  double flux = 0.0;
  for (Segment& segment : segments_) {
    segment.within = {flux};
    for (size_t i = 0; i < segment_steps; ++i) {
      flux += flux_per_intensity * step_integral(segment.value, i) / segment.per_step;
      segment.within.push_back(flux);
    }
  }
  for (Segment& segment : segments_) {
    for (double& value : segment.value) value /= flux;
    for (double& value : segment.within) value /= flux;
  }
}

// Sums from the edge inwards, so that the small flux outside an angle keeps its relative precision.
void AngularTable::find_angles(const std::vector<double>& edges_rad) {
  constexpr double negligible = 1e-9;
  double outside = 0.0, brightest = 0.0, steepest = 0.0;
  reach_rad_ = edges_rad.back();
  for (size_t s = segments_.size(); s-- > 0;) {
    const Segment& segment = segments_[s];
    const double step = 1.0 / segment.per_step;
    for (size_t i = segment_steps; i-- > 0;) {
      const double low = segment.value[i], high = segment.value[i + 1];
      const double ring = pi * step * (low + high);
      const double rise = segment.low + step * static_cast<double>(i);
      const double cosine = 1.0 - rise - 0.5 * step;
      mean_cosine_ += ring * cosine;
      mean_square_cosine_ += ring * cosine * cosine;
      if (outside < negligible) reach_rad_ = angle_of(rise + step);
      if (outside < 0.5 && outside + ring >= 0.5) {
        half_flux_rad_ = angle_of(rise + step * (outside + ring - 0.5) / ring);
      }
      outside += ring;
      brightest = std::max(brightest, low);
      // Slope per angle: dI/dθ = sin θ dI/drise.
      const double sine = std::sqrt((rise + 0.5 * step) * (2.0 - rise - 0.5 * step));
      steepest = std::max(steepest, std::abs(high - low) / step * sine);
    }
  }
  mean_cosine_ /= outside;
  mean_square_cosine_ /= outside;
  steepest_rad_ = std::min(half_flux_rad_, brightest / steepest);
  // Edges beyond the reach are moved to it: hardly any light is left there.
  for (const double edge_rad : edges_rad) {
    const double end_rad = std::min(edge_rad, reach_rad_);
    edge_slopes_.push_back(end_rad < 1.57 ? std::tan(end_rad)
                                          : std::numeric_limits<double>::infinity());
  }
}

}  // namespace photorque
