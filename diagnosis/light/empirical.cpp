// Empirical laws. They multiply the light, or add to the current, by a sum of functions with fitted
// strengths. The functions have one variable (two for a place). Waves over the receiver are found
// in the residuals of scans.
#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "diagnosis/light/candidate.h"
#include "diagnosis/light/scan.h"

namespace photorque {
namespace {

using Basis = std::function<double(const SampleConditions&)>;

LightCandidate empirical_law(const std::string& variable, const std::string& label) {
  LightCandidate c;
  c.variable = variable;
  c.is_empirical = true;
  c.name = c.kind.name = label;
  return c;
}

// The light times 1 + a cos φ + b sin φ.
template <class Phase>
void add_wave(LightState& state, double a, double b, const Phase& phase_of) {
  state.light_laws.emplace_back([a, b, phase_of](const SampleConditions& at) {
    const double phase = phase_of(at);
    return 1.0 + a * std::cos(phase) + b * std::sin(phase);
  });
}

LightCandidate light_law(const std::string& variable, const std::string& label,
                         std::vector<Basis> basis) {
  LightCandidate c = empirical_law(variable, label);
  c.kind.parameters = {{.key = "strength", .count = basis.size(), .scale = 0.05}};
  c.kind.act = [basis = std::move(basis)](LightState& state, size_t, std::span<const double> x) {
    std::vector<double> strengths(x.begin(), x.end());
    state.light_laws.emplace_back([basis, strengths](const SampleConditions& at) {
      double factor = 1.0;
      for (size_t k = 0; k < basis.size(); ++k) {
        if (strengths[k] != 0.0) factor += strengths[k] * basis[k](at);
      }
      return factor;
    });
  };
  return c;
}

// Cosines of integer half waves over the receiver, in total up to `most` in both directions.
LightCandidate over_the_receiver(int most) {
  std::vector<Basis> basis;
  for (int i = 0; i <= most; ++i) {
    for (int j = 0; j <= most; ++j) {
      if (i + j == 0 || i + j > most) continue;
      basis.emplace_back([i, j](const SampleConditions& at) {
        return std::cos(0.5 * pi * i * (at.u + 1.0)) * std::cos(0.5 * pi * j * (at.v + 1.0));
      });
    }
  }
  return light_law("position", "unknown in position", std::move(basis));
}

// A wave over the receiver in any direction, in cycles over half of its width and half of its
// height.
LightCandidate ripple() {
  LightCandidate c = empirical_law("position", "unknown in position (ripple)");
  EffectParameter waves = {.key = "waves_u",
                           .scale = 1.0,
                           .lowest = -40.0,
                           .highest = 40.0,
                           .is_strength = false,
                           .step = 0.01};
  c.kind.parameters = {{.key = "strength", .count = 2, .scale = 0.05}, waves};
  waves.key = "waves_v";
  c.kind.parameters.push_back(waves);
  c.kind.scan = LightEffectKind::Scan::wave;
  c.kind.act = [](LightState& state, size_t, std::span<const double> x) {
    add_wave(state, x[0], x[1], [u = x[2], v = x[3]](const SampleConditions& at) {
      return pi * (u * at.u + v * at.v);
    });
  };
  return c;
}

LightCandidate flicker(double longest_s) {
  LightCandidate c = empirical_law("time", "unknown in time (periodic)");
  c.kind.parameters = {{.key = "strength", .count = 2, .scale = 0.05},
                       {.key = "periods",
                        .scale = 1.0,
                        .lowest = 1.0,
                        .highest = 1e5,
                        .is_strength = false,
                        .step = 0.01}};
  for (double n = 2.0; n <= 400.0; n += n < 40.0 ? 0.5 : 1.0) {
    c.kind.parameters[1].starts.push_back(n);
  }
  c.kind.act = [longest_s](LightState& state, size_t, std::span<const double> x) {
    add_wave(state, x[0], x[1], [n = x[2], longest_s](const SampleConditions& at) {
      return 2.0 * pi * n * at.time_s / longest_s;
    });
  };
  return c;
}

LightCandidate current_over_voltage() {
  LightCandidate c = empirical_law("voltage", "unknown in voltage");
  c.kind.parameters = {{.key = "strength", .count = 5, .scale = 0.05}};
  c.kind.in_circuit = true;
  c.kind.act = [](LightState& state, size_t, std::span<const double> x) {
    state.current_laws.emplace_back(
        [strength = std::vector<double>(x.begin(), x.end())](const SampleConditions& at) {
          double sum = 0.0;
          for (size_t k = 0; k < strength.size(); ++k) {
            sum += strength[k] * std::cos(pi * static_cast<double>(k) * at.voltage);
          }
          return sum;
        });
  };
  return c;
}

struct Extent {
  double low = 1e300, high = -1e300;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double middle() const { return 0.5 * (low + high); }
  double half() const { return 0.5 * (high - low); }
};

// Powers 1 to `most` of a variable that is scaled to −1 … 1.
std::vector<Basis> powers(double SampleConditions::*variable, const Extent& e, int most) {
  std::vector<Basis> basis;
  for (int k = 1; k <= most; ++k) {
    basis.emplace_back(
        [variable, middle = e.middle(), half = e.half(), k](const SampleConditions& at) {
          return std::pow((at.*variable - middle) / half, k);
        });
  }
  return basis;
}

constexpr int most_steps = 40;
constexpr double step = 0.4;  // cycles over half of the receiver: half a cycle between its ends
constexpr int along_v = 2 * most_steps + 1;

// Sums over places for each wave of the grid.
struct WaveSums {
  std::vector<double> re, im, twice_re, twice_im;
  double square = 0.0;
  WaveSums() {
    for (auto* sum : {&re, &im, &twice_re, &twice_im}) {
      sum->assign(static_cast<size_t>(most_steps + 1) * along_v, 0.0);
    }
  }
};

// Adds a place whose reading changes by `change` standard errors per strength and deviates by `off`
// standard errors.
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

// Fall of χ² by fitting the cosine and sine of one wave.
double gain_of(const WaveSums& sums, size_t k) {
  const double a = 0.5 * (sums.square + sums.twice_re[k]),
               b = 0.5 * (sums.square - sums.twice_re[k]), c = 0.5 * sums.twice_im[k];
  const double det = a * b - c * c;
  if (!(det > 1e-9 * sums.square * sums.square)) return 0.0;
  const double g = sums.re[k], h = sums.im[k];
  return (b * g * g - 2.0 * c * g * h + a * h * h) / det;
}

}  // namespace

std::vector<LightCandidate> empirical_light_candidates(const std::vector<FittedRun>& runs) {
  std::vector<LightCandidate> all;
  Extent tilt, temperature, time, irradiance;
  bool scan = false, curves = false, moves = false;
  for (const FittedRun& r : runs) {
    const auto kind = r.run->recording().kind;
    scan = scan || kind == LightRecording::Kind::scan;
    curves = curves || kind == LightRecording::Kind::sweep;
    moves = moves || kind == LightRecording::Kind::run;
    for (const SampleConditions& at : r.run->circumstances()) {
      tilt.add(at.tilt_rad);
      if (kind != LightRecording::Kind::scan) temperature.add(at.temperature_K);
      if (kind == LightRecording::Kind::run) time.add(at.time_s);
      irradiance.add(at.irradiance);
    }
  }
  if (scan) {
    all.push_back(over_the_receiver(6));
    all.push_back(ripple());
  }
  if (irradiance.half() > 0.05) {
    all.push_back(light_law("irradiance", "unknown in irradiance",
                            powers(&SampleConditions::irradiance, irradiance, 2)));
  }
  if (tilt.half() > 0.03) {
    all.push_back(
        light_law("tilt", "unknown in tilt", powers(&SampleConditions::tilt_rad, tilt, 2)));
    all.push_back(
        light_law("heading", "unknown in heading",
                  {[](const SampleConditions& at) { return std::cos(at.heading_rad); },
                   [](const SampleConditions& at) { return std::sin(at.heading_rad); },
                   [](const SampleConditions& at) { return std::cos(2.0 * at.heading_rad); },
                   [](const SampleConditions& at) { return std::sin(2.0 * at.heading_rad); }}));
  }
  if (temperature.half() > 1.0) {
    all.push_back(light_law("temperature", "unknown in temperature",
                            powers(&SampleConditions::temperature_K, temperature, 2)));
  }
  if (moves && time.half() > 0.0) {
    std::vector<Basis> basis;
    for (int k = 1; k <= 6; ++k) {
      basis.emplace_back([k, time](const SampleConditions& at) {
        return std::cos(pi * k * (at.time_s - time.low) / (time.high - time.low));
      });
    }
    all.push_back(light_law("time", "unknown in time", std::move(basis)));
    all.push_back(flicker(time.high - time.low));
  }
  if (curves) all.push_back(current_over_voltage());
  return all;
}

std::vector<LightStart> wave_starts(const LightCandidate& wave, const std::vector<LeftOfRun>& left,
                                    const Thresholds::Scoring& limits) {
  WaveSums sums;
  for (const LeftOfRun& l : left) {
    if (l.run->recording().kind != LightRecording::Kind::scan) continue;
    for (size_t i = 0; i < l.signals.size(); ++i) {
      const SampleConditions& at = l.run->circumstances()[i];
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
