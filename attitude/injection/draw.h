// Random numbers of an injected case.
#pragma once

#include <cmath>
#include <cstdint>

#include "attitude/injection/vectors.h"
#include "core/constants.h"
#include "core/numerics/random.h"

namespace photorque::injected {

class RandomDraw {
 public:
  RandomDraw(uint64_t seed, uint64_t stream) : seed_(seed), stream_(stream) {}

  double uniform(double low, double high) { return low + (high - low) * next(); }
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  double sign() { return next() < 0.5 ? -1.0 : 1.0; }
  bool chance(double probability) { return next() < probability; }
  int below(int count) { return static_cast<int>(next() * count); }
  // Box and Muller.
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(next()));
    return radius * std::cos(2.0 * pi * next());
  }
  Triple normals(double sigma) { return {sigma * normal(), sigma * normal(), sigma * normal()}; }
  Triple direction() {
    const Triple v = normals(1.0);
    return times(1.0 / length(v), v);
  }

 private:
  double next() { return unit_interval(hash_words(seed_, stream_, counter_++, 4)); }
  uint64_t seed_, stream_, counter_ = 0;
};

}  // namespace photorque::injected
