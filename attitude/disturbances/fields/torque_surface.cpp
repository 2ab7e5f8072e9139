#include "attitude/disturbances/fields/torque_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/table.h"
#include "core/text/parse.h"

namespace photorque {

namespace {

// The cubic through f[1] and f[2], for x[1] ≤ at ≤ x[2]. Its slopes there are those of the
// parabolas through three neighbours.
Vec3 cubic_between(const std::array<double, 4>& x, const std::array<Vec3, 4>& f, double at) {
  const auto slope_at = [&](int i) -> Vec3 {
    const double before = x[i] - x[i - 1], after = x[i + 1] - x[i];
    return (after * (f[i] - f[i - 1]) / before + before * (f[i + 1] - f[i]) / after) /
           (before + after);
  };
  const double h = x[2] - x[1], t = (at - x[1]) / h;
  const Vec3 from = h * slope_at(1), to = h * slope_at(2), rise = f[2] - f[1];
  const Vec3 bend = 3.0 * rise - 2.0 * from - to, twist = from + to - 2.0 * rise;
  return f[1] + t * (from + t * (bend + t * twist));
}

// Index of the interval that contains x. If x is outside by at most one interval, it is moved to
// the end.
size_t interval(const std::vector<double>& nodes, double& x, const char* name) {
  const size_t n = nodes.size();
  if (!(x >= 2.0 * nodes[0] - nodes[1] && x <= 2.0 * nodes[n - 1] - nodes[n - 2])) {
    throw BeyondTable(std::string("wrench table: ") + name + " " + std::to_string(x / degree_rad) +
                      " deg is outside the table");
  }
  x = std::clamp(x, nodes.front(), nodes.back());
  const auto above = std::upper_bound(nodes.begin(), nodes.end() - 1, x);
  return static_cast<size_t>(std::max<std::ptrdiff_t>(above - nodes.begin() - 1, 0));
}

// Number of different nodes. A last node one turn after the first repeats the first.
size_t different_around(const std::vector<double>& nodes_rad) {
  const bool repeats =
      nodes_rad.size() > 1 && nodes_rad.back() - nodes_rad.front() > 2.0 * pi - 1e-9;
  return nodes_rad.size() - (repeats ? 1 : 0);
}

}  // namespace

TorqueSurface::TorqueSurface(const WrenchTable& table) : table_(single_valued(table)) {
  std::vector<double>& around = table_.around_rad;
  if (table_.polar_rad.size() < 2 || different_around(around) < 2) {
    throw NumericalError("wrench table: two angles or more are needed along both axes");
  }
  double widest = 0.0;
  for (size_t i = 1; i < around.size(); ++i) widest = std::max(widest, around[i] - around[i - 1]);
  const double span = around.back() - around.front();
  closed_ = span + widest > 2.0 * pi - 1e-9;
  if (different_around(around) < around.size()) {  // the last node repeats the first
    around.pop_back();
    table_.torque_body_N_m.resize(table_.nodes());
  }
  for (size_t polar = 0; polar + 1 < table_.polar_rad.size(); ++polar) {
    for (size_t i = 0; i < around.size() - (closed_ ? 0 : 1); ++i) {
      patches_.push_back(fit_patch(polar, i));
    }
  }
}

double TorqueSurface::width_around_rad(size_t i) const {
  const std::vector<double>& nodes = table_.around_rad;
  return i + 1 < nodes.size() ? nodes[i + 1] - nodes[i] : nodes.front() + 2.0 * pi - nodes.back();
}

// The surface is a cubic in both angles within a cell, determined by sixteen values.
TorqueSurface::Patch TorqueSurface::fit_patch(size_t polar, size_t around) const {
  constexpr double coefficients[4][4] = {// of the cubic through values at 0, 1/3, 2/3, 1
                                         {1.0, 0.0, 0.0, 0.0},
                                         {-5.5, 9.0, -4.5, 1.0},
                                         {9.0, -22.5, 18.0, -4.5},
                                         {-4.5, 13.5, -13.5, 4.5}};
  const double polar_rad = table_.polar_rad[polar];
  const double height_rad = table_.polar_rad[polar + 1] - polar_rad;
  const double width_rad = width_around_rad(around);
  Patch values, patch;
  for (size_t j = 0; j < 4; ++j) {
    for (size_t i = 0; i < 4; ++i) {
      values[4 * j + i] =
          through_nodes(polar_rad + height_rad * static_cast<double>(j) / 3.0,
                        table_.around_rad[around] + width_rad * static_cast<double>(i) / 3.0);
    }
  }
  patch.fill(Vec3::Zero());
  for (size_t j = 0; j < 4; ++j) {
    for (size_t i = 0; i < 4; ++i) {
      for (size_t k = 0; k < 16; ++k) {
        patch[4 * j + i] += coefficients[j][k / 4] * coefficients[i][k % 4] * values[k];
      }
    }
  }
  return patch;
}

// The cell that contains an angle. The angle is converted to its range; `held`: it is beyond an
// edge.
size_t TorqueSurface::cell_around(double& around_rad, bool* held) const {
  const std::vector<double>& nodes = table_.around_rad;
  *held = false;
  if (closed_) {
    around_rad -= 2.0 * pi * std::floor((around_rad - nodes.front()) / (2.0 * pi));
    const auto above = std::upper_bound(nodes.begin() + 1, nodes.end(), around_rad);
    return static_cast<size_t>(above - nodes.begin()) - 1;
  }
  around_rad = nodes.front() + std::remainder(around_rad - nodes.front(), 2.0 * pi);
  if (around_rad < 2.0 * nodes[0] - nodes[1]) around_rad += 2.0 * pi;
  const double wanted_rad = around_rad;
  const size_t low = interval(nodes, around_rad, "heading or azimuth");
  *held = wanted_rad != around_rad;
  return low;
}

TorqueSurface::Sample TorqueSurface::at(const TableAngles& angles) const {
  const std::vector<double>& nodes = table_.polar_rad;
  double polar_rad = angles.polar_rad, around_rad = angles.around_rad;
  const size_t low = interval(nodes, polar_rad, "tilt or elevation");
  bool held_around = false;
  const size_t cell = cell_around(around_rad, &held_around);
  const double height_rad = nodes[low + 1] - nodes[low], width_rad = width_around_rad(cell);
  const double s = (polar_rad - nodes[low]) / height_rad;
  const double t = (around_rad - table_.around_rad[cell]) / width_rad;
  const Patch& c = patches_[low * (patches_.size() / (nodes.size() - 1)) + cell];
  Sample sample{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  for (size_t j = 4; j-- > 0;) {
    const Vec3* row = &c[4 * j];
    const Vec3 value = row[0] + t * (row[1] + t * (row[2] + t * row[3]));
    const Vec3 slope = row[1] + t * (2.0 * row[2] + 3.0 * t * row[3]);
    sample.by_polar = sample.torque_body_N_m + s * sample.by_polar;
    sample.torque_body_N_m = value + s * sample.torque_body_N_m;
    sample.by_around = slope + s * sample.by_around;
  }
  // Beyond an edge, the value at the edge is used.
  sample.by_polar *= polar_rad != angles.polar_rad ? 0.0 : 1.0 / height_rad;
  sample.by_around *= held_around ? 0.0 : 1.0 / width_rad;
  return sample;
}

// Interpolates a row of nodes with equal polar angle in the other angle.
Vec3 TorqueSurface::row_at(size_t polar, double around_rad) const {
  const std::vector<double>& nodes = table_.around_rad;
  const auto n = static_cast<std::ptrdiff_t>(nodes.size());
  bool held = false;
  const auto low = static_cast<std::ptrdiff_t>(cell_around(around_rad, &held));
  std::array<double, 4> x{};
  std::array<Vec3, 4> f;
  for (int k = 0; k < 4; ++k) {
    const std::ptrdiff_t i = low - 1 + k;
    const std::ptrdiff_t turns = i < 0 ? -1 : i >= n ? 1 : 0;
    if (closed_ || turns == 0) {
      const auto j = static_cast<size_t>(i - turns * n);
      x[k] = nodes[j] + 2.0 * pi * static_cast<double>(turns);
      f[k] = table_.torque_body_N_m[table_.node(j, polar)];
    } else {  // linear extrapolation beyond the edge
      const size_t edge = i < 0 ? 0 : nodes.size() - 1, inner = i < 0 ? 1 : nodes.size() - 2;
      x[k] = 2.0 * nodes[edge] - nodes[inner];
      f[k] = 2.0 * table_.torque_body_N_m[table_.node(edge, polar)] -
             table_.torque_body_N_m[table_.node(inner, polar)];
    }
  }
  return cubic_between(x, f, around_rad);
}

bool TorqueSurface::beyond_is_pole(bool below) const {
  const bool tilt = table_.angles == WrenchTable::Angles::tilt_heading;
  const double pole = tilt ? (below ? 0.0 : pi) : (below ? -0.5 * pi : 0.5 * pi);
  const double edge = below ? table_.polar_rad.front() : table_.polar_rad.back();
  return closed_ && std::abs(edge - pole) < 1e-9;
}

// The row beyond the first or last one. Beyond a pole it is that of the opposite side; elsewhere
// the edge is extrapolated linearly.
Vec3 TorqueSurface::ghost_row(bool below, double around_rad, double* polar_rad) const {
  const std::vector<double>& nodes = table_.polar_rad;
  const size_t edge = below ? 0 : nodes.size() - 1, inner = below ? 1 : nodes.size() - 2;
  *polar_rad = 2.0 * nodes[edge] - nodes[inner];
  if (beyond_is_pole(below)) return row_at(inner, around_rad + pi);
  return 2.0 * row_at(edge, around_rad) - row_at(inner, around_rad);
}

Vec3 TorqueSurface::through_nodes(double polar_rad, double around_rad) const {
  const std::vector<double>& nodes = table_.polar_rad;
  const size_t low = interval(nodes, polar_rad, "tilt or elevation");
  std::array<double, 4> x{};
  std::array<Vec3, 4> value;
  for (size_t k = 0; k < 4; ++k) {
    const bool below = low + k == 0, above = low + k > nodes.size();
    if (below || above) {
      value[k] = ghost_row(below, around_rad, &x[k]);
    } else {
      x[k] = nodes[low + k - 1];
      value[k] = row_at(low + k - 1, around_rad);
    }
  }
  return cubic_between(x, value, polar_rad);
}

namespace {

// Checks the number of rows before memory for the whole grid is allocated.
void require_grid(const std::filesystem::path& path, size_t rows,
                  const std::vector<double>& polar_rad, const std::vector<double>& around_rad) {
  const size_t polar = polar_rad.size(), around = different_around(around_rad);
  if (polar < 2 || around < 2) {
    throw InputError({path.string()}, "",
                     std::to_string(polar) + " by " + std::to_string(around) + " different angles",
                     "two or more along both axes");
  }
  const size_t nodes = polar * around_rad.size();
  if (rows < nodes) {
    throw InputError({path.string()}, "", std::to_string(rows) + " rows",
                     std::to_string(nodes) + " rows, one for every pair of angles");
  }
}

}  // namespace

WrenchTable read_wrench_table(const std::filesystem::path& path) {
  const std::vector<std::string> header = read_column_names(path);
  const bool tilt = std::find(header.begin(), header.end(), "tilt_deg") != header.end();
  const NumberColumns file = read_number_columns(
      path, {tilt ? "tilt_deg" : "elevation_deg", tilt ? "heading_deg" : "azimuth_deg",
             "torque_x_N_m", "torque_y_N_m", "torque_z_N_m"});
  std::map<double, size_t> polar, around;
  for (const double x : file.columns[0]) polar[x * degree_rad] = 0;
  for (const double x : file.columns[1]) around[x * degree_rad] = 0;
  const auto number = [](std::map<double, size_t>& axis) {
    std::vector<double> nodes;
    for (auto& [x, index] : axis) {
      index = nodes.size();
      nodes.push_back(x);
    }
    return nodes;
  };
  const std::vector<double> polar_rad = number(polar), around_rad = number(around);
  require_grid(path, file.lines.size(), polar_rad, around_rad);
  WrenchTable table = make_wrench_table(
      tilt ? WrenchTable::Angles::tilt_heading : WrenchTable::Angles::azimuth_elevation, polar_rad,
      around_rad);
  std::vector<bool> filled(table.nodes(), false);
  for (size_t i = 0; i < file.lines.size(); ++i) {
    const size_t node =
        table.node(around[file.columns[1][i] * degree_rad], polar[file.columns[0][i] * degree_rad]);
    if (filled[node]) {
      throw InputError({path.string(), file.lines[i]}, "", "a direction that was there before",
                       "every pair of angles once");
    }
    filled[node] = true;
    table.torque_body_N_m[node] = {file.columns[2][i], file.columns[3][i], file.columns[4][i]};
  }
  return table;
}

}  // namespace photorque
