// Waves over the receiver, in what is left of scans.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/constants.h"
#include "diagnosis/light/trials/scan.h"

namespace photorque {
namespace {

constexpr int most_steps = 40;
constexpr double step = 0.4;  // cycles over half of the receiver: its ends are half a cycle apart
constexpr int along_v = 2 * most_steps + 1;

// Sums over places, of each wave of the grid.
struct WaveSums {
  std::vector<double> re, im, twice_re, twice_im;
  double square = 0.0;
  WaveSums() {
    for (auto* sum : {&re, &im, &twice_re, &twice_im}) {
      sum->assign(static_cast<size_t>(most_steps + 1) * along_v, 0.0);
    }
  }
};

// Adds a place whose reading changes by `change` errors per strength and is `off` errors off.
void add_place(double u, double v, double change, double off, WaveSums& sums) {
  std::array<double, along_v> cos_v, sin_v;
  for (int n = 0; n < along_v; ++n) {
    const double phase = pi * step * (n - most_steps) * v;
    cos_v[static_cast<size_t>(n)] = std::cos(phase);
    sin_v[static_cast<size_t>(n)] = std::sin(phase);
  }
  const double first = change * off, second = change * change;
  sums.square += second;
  for (int m = 0; m <= most_steps; ++m) {
    const double cos_u = std::cos(pi * step * m * u), sin_u = std::sin(pi * step * m * u);
    const auto row = static_cast<size_t>(m) * along_v;
    for (size_t n = 0; n < along_v; ++n) {
      const double c = cos_u * cos_v[n] - sin_u * sin_v[n], s = sin_u * cos_v[n] + cos_u * sin_v[n];
      sums.re[row + n] += first * c;
      sums.im[row + n] += first * s;
      sums.twice_re[row + n] += second * (c * c - s * s);
      sums.twice_im[row + n] += second * 2.0 * c * s;
    }
  }
}

// The fall of χ² with cosine and sine of one wave.
double gain_of(const WaveSums& sums, size_t k) {
  const double a = 0.5 * (sums.square + sums.twice_re[k]),
               b = 0.5 * (sums.square - sums.twice_re[k]), c = 0.5 * sums.twice_im[k];
  const double det = a * b - c * c;
  if (!(det > 1e-9 * sums.square * sums.square)) return 0.0;
  const double g = sums.re[k], h = sums.im[k];
  return (b * g * g - 2.0 * c * g * h + a * h * h) / det;
}

}  // namespace

std::vector<LightStart> wave_starts(const LightCandidate& wave, const std::vector<LeftOfRun>& left,
                                    const Thresholds::Scoring& limits) {
  WaveSums sums;
  for (const LeftOfRun& l : left) {
    if (l.run->recording().kind != LightRecording::Kind::scan) continue;
    for (size_t i = 0; i < l.signals.size(); ++i) {
      const Circumstance& at = l.run->circumstances()[i];
      add_place(at.u, at.v, -l.slopes.of_scan[i] * l.signals[i],
                l.residuals[static_cast<Eigen::Index>(i)], sums);
    }
  }
  struct Found {
    double gain, u, v;
  };
  std::vector<Found> found;
  for (int m = 0; m <= most_steps; ++m) {
    for (int n = m == 0 ? most_steps + 1 : 0; n < along_v; ++n) {
      const double gain = gain_of(sums, static_cast<size_t>(m) * along_v + static_cast<size_t>(n));
      if (gain >= limits.min_scan_gain) found.push_back({gain, step * m, step * (n - most_steps)});
    }
  }
  std::ranges::stable_sort(found, [](const Found& a, const Found& b) { return a.gain > b.gain; });
  constexpr size_t most = 3;
  if (found.size() > most) found.resize(most);
  std::vector<LightStart> starts;
  for (const Found& f : found) {
    LightStart start{wave.start()};
    start.x[2] = f.u;
    start.x[3] = f.v;
    starts.push_back(std::move(start));
  }
  return starts;
}

}  // namespace photorque
