#include "diagnosis/attitude/timing.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "attitude/estimation/free_inertia.h"

namespace photorque {
namespace {

// What is left where all rates are multiplied by a factor; infinite where no inertia comes out.
double left_by(double factor, std::vector<Observation> pieces) {
  for (Observation& seen : pieces) {
    for (Vec3& rate : seen.gyro_rad_s) rate *= factor;
  }
  const auto found = free_inertia(pieces);
  return found ? found->left : INFINITY;
}

struct Factor {
  double value = 1.0, left = INFINITY;
};

// The least over factors from 0.3 to 3: the best of a grid, then by golden sections about it.
Factor best_factor(const std::vector<Observation>& pieces) {
  constexpr double widest = 1.1, step = 0.1;  // of the logarithm
  double best = 0.0, least = INFINITY;
  for (double log = -widest; log < widest + 0.5 * step; log += step) {
    const double left = left_by(std::exp(log), pieces);
    if (left < least) {
      least = left;
      best = log;
    }
  }
  constexpr double section = 0.3819660112501051;
  double low = best - step, high = best + step;
  double a = low + section * (high - low), b = high - section * (high - low);
  double left_a = left_by(std::exp(a), pieces), left_b = left_by(std::exp(b), pieces);
  for (int i = 0; i < 16; ++i) {
    if (left_a < left_b) {
      high = b;
      b = a;
      left_b = left_a;
      a = low + section * (high - low);
      left_a = left_by(std::exp(a), pieces);
    } else {
      low = a;
      a = b;
      left_a = left_b;
      b = high - section * (high - low);
      left_b = left_by(std::exp(b), pieces);
    }
  }
  const double log = 0.5 * (low + high);
  return {std::exp(log), left_by(std::exp(log), pieces)};
}

}  // namespace

std::vector<InstrumentFinding> clock_findings(const Platform& platform, const RecordedData& data) {
  if (platform.has_bearing()) return {};
  constexpr size_t most_rows = 400;
  std::map<std::string, std::vector<Observation>> pieces;
  for (const auto* runs : {&data.train, &data.held}) {
    for (const Observation& seen : *runs) {
      if (seen.sees_some_attitude()) return {};
      pieces[seen.name].push_back(seen.averaged(most_rows));
    }
  }
  constexpr double least_change = 0.05, better = 1.0 / 3.0, good = 0.05;
  std::vector<InstrumentFinding> findings;
  for (const auto& [name, own] : pieces) {
    const double as_read = left_by(1.0, own);
    const Factor best = best_factor(own);
    if (!(best.left < good) || !(best.left < better * as_read) ||
        std::abs(best.value - 1.0) < least_change) {
      continue;
    }
    char text[400];
    std::snprintf(
        text, sizeof text,
        "%s: rates and clock contradict each other: only with rates %.3g times as large, or "
        "times %.3g times as long, do the rates change as any inertia makes them",
        std::filesystem::path(name).filename().c_str(), best.value, best.value);
    findings.push_back({"time", "clock_factor", best.value, 0.0, text});
  }
  return findings;
}

}  // namespace photorque
