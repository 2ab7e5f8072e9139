#include "tools/proof/light/readings.h"

#include <algorithm>

namespace photorque::injected {
namespace {

// Gauss's rule of four on (0, 1).
constexpr std::array<double, 4> gauss_at = {0.06943184420297371, 0.3300094782075719,
                                            0.6699905217924281, 0.9305681557970263};
constexpr std::array<double, 4> gauss_share = {0.17392742256872692, 0.32607257743127308,
                                               0.32607257743127308, 0.17392742256872692};

// Points of a cell and their shares: u and v as fractions of it.
using CellRule = std::vector<std::array<double, 3>>;

// Gauss's rule in each half: beams may be narrower than a cell.
CellRule smooth_cell_rule() {
  std::vector<std::array<double, 2>> along;
  for (const double half : {0.0, 0.5}) {
    for (size_t i = 0; i < gauss_at.size(); ++i) {
      along.push_back({half + 0.5 * gauss_at[i], 0.5 * gauss_share[i]});
    }
  }
  CellRule rule;
  for (const auto& u : along) {
    for (const auto& v : along) rule.push_back({u[0], v[0], u[1] * v[1]});
  }
  return rule;
}

// For cells that the edge of a shadow crosses: with 14 points a side it erred by 0.3 %.
CellRule fine_cell_rule() {
  constexpr int side = 42;
  CellRule rule;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      rule.push_back({(i + 0.5) / side, (j + 0.5) / side, 1.0 / (side * side)});
    }
  }
  return rule;
}

template <class T>
std::vector<T> chosen(const std::vector<T>& all, const std::vector<size_t>& rows) {
  std::vector<T> some;
  for (const size_t row : rows) {
    if (!all.empty()) some.push_back(all[row]);
  }
  return some;
}

size_t cell_at(const LightWorld& world, double u_m, double v_m) {
  const InjectedPlate& p = world.light.plate;
  const auto along = [](double x, double low, double high, int count) {
    return static_cast<size_t>(
        std::clamp(static_cast<int>((x - low) / (high - low) * count), 0, count - 1));
  };
  return along(v_m, p.v_low_m, p.v_high_m, world.circuit.rows) *
             static_cast<size_t>(world.circuit.columns) +
         along(u_m, p.u_low_m, p.u_high_m, world.circuit.columns);
}

double law_at(const LightWorld& world, const InjectedPlace& place) {
  double factor = 1.0;
  for (const auto& law : world.laws) factor *= law(place);
  return factor;
}

std::vector<double> scanned(const LightWorld& world, const LightRows& rows) {
  std::vector<double> readings;
  for (size_t first = 0; first < rows.size();) {
    size_t last = first;
    std::vector<std::array<double, 2>> points;
    while (last < rows.size() && rows.attitude[last] == rows.attitude[first]) {
      points.push_back({rows.u_m[last], rows.v_m[last]});
      ++last;
    }
    const auto light = injected_light(world.light, rows.attitude[first], points, false);
    for (size_t k = 0; k < light.size(); ++k) {
      const auto [u, v] = points[k];
      readings.push_back(light[k] * world.circuit.cell_light[cell_at(world, u, v)] *
                         world.detector_gain * law_at(world, {u, v, 0.0}));
    }
    first = last;
  }
  return readings;
}

}  // namespace

LightRows LightRows::part(const std::vector<size_t>& which) const {
  LightRows some = *this;
  some.attitude = chosen(attitude, which);
  some.tilt_deg = chosen(tilt_deg, which);
  some.heading_deg = chosen(heading_deg, which);
  some.u_m = chosen(u_m, which);
  some.v_m = chosen(v_m, which);
  some.voltage_V = chosen(voltage_V, which);
  some.time_s = chosen(time_s, which);
  some.temperature_K = chosen(temperature_K, which);
  some.sweep = chosen(sweep, which);
  return some;
}

std::vector<double> light_on_cells(const LightWorld& world, const Quaternion& attitude) {
  static const CellRule smooth = smooth_cell_rule(), fine = fine_cell_rule();
  const InjectedPlate& p = world.light.plate;
  const double width = (p.u_high_m - p.u_low_m) / world.circuit.columns,
               height = (p.v_high_m - p.v_low_m) / world.circuit.rows;
  const auto add_points = [&](size_t cell, const CellRule& rule,
                              std::vector<std::array<double, 2>>& points) {
    const auto columns = static_cast<size_t>(world.circuit.columns);
    const size_t rows_before = cell / columns, columns_before = cell % columns;
    const auto row = static_cast<double>(rows_before), column = static_cast<double>(columns_before);
    for (const auto& at : rule) {
      points.push_back({p.u_low_m + (column + at[0]) * width, p.v_low_m + (row + at[1]) * height});
    }
  };
  const auto mean = [](const CellRule& rule, const double* light) {
    double sum = 0.0;
    for (size_t k = 0; k < rule.size(); ++k) sum += rule[k][2] * light[k];
    return sum;
  };
  std::vector<std::array<double, 2>> points;
  std::vector<double> cells(world.circuit.cells());
  for (size_t cell = 0; cell < cells.size(); ++cell) add_points(cell, smooth, points);
  const auto light = injected_light(world.light, attitude, points, true);
  const auto shaded = may_be_shaded(world.light, attitude, points);
  for (size_t cell = 0; cell < cells.size(); ++cell) {
    const auto first = static_cast<std::ptrdiff_t>(cell * smooth.size()),
               last = first + static_cast<std::ptrdiff_t>(smooth.size());
    cells[cell] = mean(smooth, &light[static_cast<size_t>(first)]);
    if (std::find(shaded.begin() + first, shaded.begin() + last, true) == shaded.begin() + last) {
      continue;
    }
    std::vector<std::array<double, 2>> finer;
    add_points(cell, fine, finer);
    cells[cell] = mean(fine, injected_light(world.light, attitude, finer, true).data());
  }
  return cells;
}

std::vector<double> injected_readings(const LightWorld& world, const LightRows& rows,
                                      bool voltage_is_set) {
  if (rows.kind == LightRows::Kind::scan) return scanned(world, rows);
  std::vector<double> readings, light;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (i == 0 || rows.attitude[i] != rows.attitude[i - 1]) {
      light = light_on_cells(world, rows.attitude[i]);
    }
    std::vector<double> now = light;
    if (rows.kind == LightRows::Kind::run) {
      const double t = rows.time_s[i];
      const double factor = (1.0 - world.droop_depth * (1.0 - std::exp(-t / world.droop_time_s))) *
                            law_at(world, {0.0, 0.0, t});
      for (double& x : now) {
        x = (x - world.light.ambient_W_m2) * factor + world.light.ambient_W_m2;
      }
    }
    const LitCircuit circuit(world.circuit, now, rows.temperature_K[i]);
    if (rows.kind == LightRows::Kind::sweep) {
      readings.push_back(circuit.current_A(rows.voltage_V[i]));
      continue;
    }
    if (voltage_is_set) {
      readings.push_back(rows.voltage_V[i]);
      readings.push_back(circuit.current_A(rows.voltage_V[i]));
      continue;
    }
    const auto maxima = circuit.maxima();
    bool trapped = false;
    for (const auto& [from_s, to_s] : world.trapped_s) {
      trapped = trapped || (rows.first && rows.time_s[i] >= from_s && rows.time_s[i] <= to_s);
    }
    const size_t which = trapped && maxima.size() > 1 ? 1 : 0;
    readings.push_back(maxima.empty() ? 0.0 : maxima[which].voltage_V);
    readings.push_back(maxima.empty() ? 0.0 : maxima[which].current_A);
  }
  return readings;
}

std::vector<double> reading_errors(const LightWorld& world, const LightRows& rows,
                                   const LightNoiseStated& noise,
                                   const std::vector<double>& readings) {
  std::vector<double> errors;
  if (rows.kind == LightRows::Kind::scan) {
    for (const double E : readings) {
      errors.push_back(std::hypot(noise.irradiance_W_m2, noise.relative * E));
    }
    return errors;
  }
  const bool is_set = rows.kind == LightRows::Kind::sweep || noise.tracker_step_V > 0.0;
  if (!is_set) {
    for (size_t i = 0; i < rows.size(); ++i) {
      errors.push_back(noise.voltage_V);
      errors.push_back(noise.current_A);
    }
    return errors;
  }
  LightRows moved = rows;
  constexpr double step_V = 1e-3;
  for (double& v : moved.voltage_V) v += step_V;
  const auto beside = injected_readings(world, moved, true);
  const bool run = rows.kind == LightRows::Kind::run;
  for (size_t k = 0; k < readings.size(); ++k) {
    const double slope = (beside[k] - readings[k]) / step_V;
    errors.push_back(run && k % 2 == 0 ? 1e9
                                       : std::hypot(noise.current_A, slope * noise.voltage_V));
  }
  return errors;
}

}  // namespace photorque::injected
