// Random errors of readings, the same in every run.
#pragma once

#include <cstdint>
#include <random>

namespace photorque {

// Independent numbers of a normal distribution about zero.
class Noise {
 public:
  explicit Noise(uint64_t seed, double sigma = 1.0) : engine_(seed), normal_(0.0, sigma) {}
  double operator()() { return normal_(engine_); }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace photorque
