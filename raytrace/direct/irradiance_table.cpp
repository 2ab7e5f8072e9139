#include "raytrace/direct/irradiance_table.h"

#include <algorithm>
#include <cmath>

#include "core/numerics/interpolation.h"
#include "core/parallel.h"

namespace photorque {
namespace {

constexpr double root_half = 0.70710678118654752440;

// Terms of a series whose next falls by `ratio`, `most` at most: heights on a scale of their
// middle.
size_t degrees_for(double ratio, size_t most) {
  constexpr double negligible = 1e-8;
  if (ratio < 1e-9) return 1;
  const double wanted = 1.0 + std::log(negligible) / std::log(std::min(ratio, 0.5));
  return std::min(static_cast<size_t>(wanted) + 1, most);
}

}  // namespace

template <int Count>
FactorTable<Count>::FactorTable(double low_m, double high_m, std::vector<Kink> kinks, size_t steps)
    : middle_m_(0.5 * (low_m + high_m)),
      half_range_m_(0.5 * (high_m - low_m)),
      degrees_(degrees_for(half_range_m_ / middle_m_, max_degrees)),
      steps_(steps),
      kinks_(std::move(kinks)),
      nodes_(2 * (kinks_.size() - 1) * (steps + 1)) {}

// Empty if they cross within the range of heights, or if the light extends to the side.
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
std::optional<FactorTable<Count>> FactorTable<Count>::make(const DiscLight& light,
                                                           const Function& factors, double low_m,
                                                           double high_m, int threads) {
  const auto kinks = kinks_of(light, low_m, high_m);
  if (!kinks) return std::nullopt;
  const double middle_m = 0.5 * (low_m + high_m);
  std::optional<FactorTable> coarser;
  for (size_t steps = fewest_steps; steps <= most_steps; steps *= 2) {
    FactorTable table(low_m, high_m, *kinks, steps);
    table.fill(factors, coarser ? &*coarser : nullptr, threads);
    if (table.agrees_with(factors)) return table;
    // Cubics gain four powers of two with every halving of the steps.
    const double most_gain =
        std::pow(static_cast<double>(most_steps) / static_cast<double>(steps), 4.0);
    if (table.error_ > 2.0 * most_gain * tolerance * light.typical_W_m2(middle_m)) break;
    coarser = std::move(table);
  }
  return std::nullopt;
}

template <int Count>
double FactorTable<Count>::distance_m(size_t half, double place, double height_m) const {
  const double from = kinks_[half / 2].at(height_m), to = kinks_[half / 2 + 1].at(height_m);
  const double root = root_half * place / static_cast<double>(steps_);
  return half % 2 == 0 ? from + root * root * (to - from) : to - root * root * (to - from);
}

template <int Count>
void FactorTable<Count>::fill(const Function& factors, const FactorTable* coarser, int threads) {
  parallel_for(nodes_.size(), threads, [&](size_t n) {
    const size_t half = n / (steps_ + 1), place = n % (steps_ + 1);
    Node& node = nodes_[n];
    if (coarser != nullptr && place % 2 == 0) {
      node = coarser->nodes_[half * (coarser->steps_ + 1) + place / 2];
      return;
    }
    node.setZero();
    for (size_t j = 0; j < degrees_; ++j) {
      const double x = chebyshev_point(degrees_, j);
      const double h = middle_m_ + half_range_m_ * x;
      const Factors here = factors(distance_m(half, static_cast<double>(place), h), h);
      for (size_t k = 0; k < degrees_; ++k) {
        const double weight = chebyshev_weight(degrees_, k, std::acos(x));
        node.row(static_cast<Eigen::Index>(k)) += weight * here.transpose();
      }
    }
  });
}

template <int Count>
bool FactorTable<Count>::agrees_with(const Function& factors) {
  constexpr size_t stride = 7;  // intervals between two that are looked at
  double largest = 0.0, worst = 0.0;
  for (const double x : {-0.97, 0.31}) {
    const double h = middle_m_ + half_range_m_ * x;
    for (size_t half = 0; half < 2 * (kinks_.size() - 1); ++half) {
      for (size_t step = 0; step < steps_; step += stride) {
        const double d = distance_m(half, static_cast<double>(step) + 0.5, h);
        const Factors truth = factors(d, h);
        largest = std::max(largest, truth[0]);
        worst = std::max(worst, (at(d, h) - truth).abs().maxCoeff());
      }
    }
  }
  error_ = worst;
  return worst <= tolerance * largest;
}

template <int Count>
typename FactorTable<Count>::Factors FactorTable<Count>::at(double distance_m,
                                                            double height_m) const {
  const double h = height_m, d = distance_m;
  if (d >= kinks_.back().at(h)) return Factors::Zero();
  size_t piece = 0;
  while (d >= kinks_[piece + 1].at(h)) ++piece;
  const double from = kinks_[piece].at(h), to = kinks_[piece + 1].at(h);
  const double along = (d - from) / (to - from);
  const bool near = along < 0.5;
  const double place = std::sqrt(2.0 * (near ? along : 1.0 - along)) * static_cast<double>(steps_);

  // The cubic through four neighbours.
  const auto first = std::min(static_cast<size_t>(std::max(place - 1.0, 0.0)), steps_ - 3);
  const double t = place - static_cast<double>(first) - 1.0;
  const double left = t + 1.0, right = t - 1.0, far = t - 2.0;
  const std::array<double, 4> weight = {-t * right * far / 6.0, left * right * far / 2.0,
                                        -left * t * far / 2.0, left * t * right / 6.0};
  const Node* node = &nodes_[(2 * piece + (near ? 0 : 1)) * (steps_ + 1) + first];
  Factors factor = Factors::Zero();
  if (degrees_ == 1) {
    for (Eigen::Index f = 0; f < Count; ++f) {
      for (size_t i = 0; i < 4; ++i) factor[f] += weight[i] * node[i](0, f);
    }
    return factor;
  }
  const Node series =
      weight[0] * node[0] + weight[1] * node[1] + weight[2] * node[2] + weight[3] * node[3];
  const double x = (h - middle_m_) / half_range_m_;
  double term = 1.0, next = x;
  for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(degrees_); ++k) {
    for (Eigen::Index f = 0; f < Count; ++f) factor[f] += term * series(k, f);
    const double after = 2.0 * x * next - term;
    term = next;
    next = after;
  }
  return factor;
}

template class FactorTable<2>;
template class FactorTable<6>;

}  // namespace photorque
