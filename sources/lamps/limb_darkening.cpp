#include "sources/lamps/limb_darkening.h"

#include <algorithm>
#include <cmath>

namespace photorque {
namespace {

constexpr size_t steps = 4096;

}  // namespace

// With sin²θ = (1 − μ²) sin²α the element of solid angle is 2π d(−cos θ) = 2π sin²α μ dμ/cos θ.
LimbDarkening::LimbDarkening(double angular_radius_rad, double u1, double u2)
    : sine2_(std::sin(angular_radius_rad) * std::sin(angular_radius_rad)), u1_(u1), u2_(u2) {
  // From the middle, μ = 1, outwards; by the middle of each step.
  std::vector<double> within = {0.0};
  double projected = 0.0;
  for (size_t i = 0; i < steps; ++i) {
    const double cosine = 1.0 - (static_cast<double>(i) + 0.5) / steps;
    const double light = radiance(cosine) * cosine;
    const double facing = std::sqrt(1.0 - (1.0 - cosine * cosine) * sine2_);
    within.push_back(within.back() + light / facing);
    projected += light;
  }
  mean_cosine_ = projected / within.back();
  size_t at = 1;
  for (size_t k = 0; k <= steps; ++k) {
    const double wanted = within.back() * static_cast<double>(k) / steps;
    while (at < steps && within[at] < wanted) ++at;
    const double place = (wanted - within[at - 1]) / (within[at] - within[at - 1]);
    cosine_of_fraction_.push_back(1.0 - (static_cast<double>(at - 1) + place) / steps);
  }
}

double LimbDarkening::radiance(double cosine) const {
  const double depth = 1.0 - cosine;
  return 1.0 - u1_ * depth - u2_ * depth * depth;
}

double LimbDarkening::cosine_at(double angle_rad) const {
  const double sine = std::sin(angle_rad);
  return std::sqrt(std::max(0.0, 1.0 - sine * sine / sine2_));
}

double LimbDarkening::rise_at(double cosine) const {
  const double sine2 = (1.0 - cosine * cosine) * sine2_;
  return sine2 / (1.0 + std::sqrt(1.0 - sine2));
}

double LimbDarkening::rise_within(double fraction) const {
  const double place = fraction * steps;
  const size_t i = std::min(static_cast<size_t>(place), steps - 1);
  const double t = place - static_cast<double>(i);
  // Linear in the rise, which goes like the fraction itself near the middle.
  return (1.0 - t) * rise_at(cosine_of_fraction_[i]) + t * rise_at(cosine_of_fraction_[i + 1]);
}

std::vector<double> LimbDarkening::edges_rad() const {
  std::vector<double> edges;
  for (double cosine = 0.5; cosine > 0.03; cosine *= 0.5) {
    edges.push_back(std::asin(std::sqrt((1.0 - cosine * cosine) * sine2_)));
  }
  edges.push_back(std::asin(std::sqrt(sine2_)));
  return edges;
}

}  // namespace photorque
