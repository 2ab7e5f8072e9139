#include "photovoltaics/cell/batch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/lanes.h"
#include "photovoltaics/cell/cell.h"

namespace photorque {
namespace {

constexpr size_t width = Lanes::count;

struct LaneCells {
  Lanes photocurrent_A, saturation_A, scale_V, series_ohm, shunt_S;
};

struct LanePoints {
  Lanes voltage_V, current_A;
  Lanes last_step;  // of V_d over n V_t
};

// The ideal cell, x + ln(1 + x) = L, by two rounds of substitution; then dP/dV_d = 0 solved for the
// exponential with what that says about the current: I₀ e^x/nV_t = I/(V_d − 2 I R_s) − 1/R_sh.
Lanes first_guess(const LaneCells& c) {
  const Lanes total = log(c.photocurrent_A / c.saturation_A + 1.0);
  const Lanes x = total - log(1.0 + total - log(1.0 + total));
  const Lanes v = c.scale_V * x;
  const Lanes junction_A = (c.photocurrent_A + c.saturation_A) / (1.0 + x);
  const Lanes current = max(junction_A * x - c.shunt_S * v, 0.3 * junction_A * x);
  const Lanes arm = max(v - 2.0 * current * c.series_ohm, 0.2 * v);
  const Lanes junction_S = max(current / arm - c.shunt_S, 0.2 * current / arm);
  return c.scale_V * log(junction_S * c.scale_V / c.saturation_A);
}

LanePoints solve(const LaneCells& c) {
  constexpr int steps = 4;
  const Lanes per_scale = 1.0 / c.scale_V;
  Lanes v = first_guess(c), step = 0.0;
  for (int i = 0; i < steps; ++i) {
    const Lanes junction_A = c.saturation_A * exp(v * per_scale);
    const Lanes current = c.photocurrent_A + c.saturation_A - junction_A - c.shunt_S * v;
    const Lanes junction_S = junction_A * per_scale;
    const Lanes d1 = junction_S + c.shunt_S;
    const Lanes d2 = junction_S * per_scale;
    const Lanes arm = v - 2.0 * current * c.series_ohm;
    const Lanes arm1 = 1.0 + 2.0 * d1 * c.series_ohm;
    const Lanes f = current - d1 * arm;
    const Lanes f1 = -d1 * (1.0 + arm1) - d2 * arm;
    const Lanes f2 = -d2 * (1.0 + 2.0 * arm1 + arm * per_scale + 2.0 * d1 * c.series_ohm);
    step = 2.0 * f * f1 / (2.0 * f1 * f1 - f * f2);
    v -= step;
  }
  const Lanes current =
      c.photocurrent_A + c.saturation_A - c.saturation_A * exp(v * per_scale) - c.shunt_S * v;
  return {v - current * c.series_ohm, current, step * per_scale};
}

CellOperatingPoint solve_alone(const SingleDiodeCells& cells, size_t i) {
  CellParameters p;
  p.saturation_1_A = cells.saturation_A[i];
  p.ideality_1 = 1.0;
  p.temperature_K = cells.scale_V[i] * elementary_charge_C / boltzmann_J_K;
  p.series_ohm = cells.series_ohm[i];
  p.shunt_ohm = 1.0 / std::max(cells.shunt_S[i], 1e-30);
  return CellCurve(p).maximum_power(cells.photocurrent_A[i]);
}

// The last cell stands in for those that are missing.
Lanes load(std::span<const double> values, size_t first) {
  std::array<double, width> lanes;
  for (size_t k = 0; k < width; ++k) lanes[k] = values[std::min(first + k, values.size() - 1)];
  return Lanes(lanes);
}

// Cubic convergence: what is left is far below the last step cubed. A maximum lies at V, I > 0.
// Where the photocurrent is below I₀ the exponential minus one would lose digits.
bool is_solved(const LaneCells& c, const LanePoints& points, int lane) {
  return std::abs(points.last_step[lane]) < 1e-5 && points.voltage_V[lane] > 0.0 &&
         points.current_A[lane] > 0.0 && c.photocurrent_A[lane] > c.saturation_A[lane];
}

}  // namespace

void maximum_power_points(const SingleDiodeCells& cells, std::span<double> voltage_V,
                          std::span<double> current_A) {
  const size_t count = cells.photocurrent_A.size();
  for (const size_t size :
       {cells.saturation_A.size(), cells.scale_V.size(), cells.series_ohm.size(),
        cells.shunt_S.size(), voltage_V.size(), current_A.size()}) {
    if (size != count) {
      throw InputError({}, "cells", std::to_string(size) + " entries", std::to_string(count));
    }
  }
  for (size_t first = 0; first < count; first += width) {
    const LaneCells c{load(cells.photocurrent_A, first), load(cells.saturation_A, first),
                      load(cells.scale_V, first), load(cells.series_ohm, first),
                      load(cells.shunt_S, first)};
    const LanePoints points = solve(c);
    for (size_t k = 0; k < std::min(width, count - first); ++k) {
      const auto lane = static_cast<int>(k);
      CellOperatingPoint at{points.voltage_V[lane], points.current_A[lane]};
      if (!is_solved(c, points, lane)) at = solve_alone(cells, first + k);
      voltage_V[first + k] = at.voltage_V;
      current_A[first + k] = at.current_A;
    }
  }
}

}  // namespace photorque
