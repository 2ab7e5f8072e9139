#include "receivers/wrench/table_product.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/constants.h"
#include "core/parallel.h"
#include "core/product.h"

namespace photorque {
namespace {

constexpr int side = 241;  // nodes along each side of the picture of a disc
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// One component of the torque as a smooth function of both angles of a table.
class SmoothComponent {
 public:
  // Empty unless the azimuths (headings) cover the whole circle in equal steps.
  static std::optional<SmoothComponent> of(const WrenchTable& table, int axis) {
    constexpr double same = 1e-6;
    std::vector<double> around = table.around_rad;
    if (around.size() > 3 && std::abs(around.back() - around.front() - 2.0 * pi) < same) {
      around.pop_back();
    }
    const auto count = static_cast<double>(around.size());
    if (around.size() < 3 || table.polar_rad.size() < 2) return std::nullopt;
    for (size_t i = 0; i < around.size(); ++i) {
      const double even = around[0] + 2.0 * pi * static_cast<double>(i) / count;
      if (std::abs(around[i] - even) > same) return std::nullopt;
    }
    return SmoothComponent(table, std::move(around), axis);
  }

  // The interpolated value, a weighted sum of the values at the nodes, and its standard error.
  Estimate operator()(double polar_rad, double around_rad) const {
    // The four nodes around the polar angle, some of them possibly beyond a pole.
    const std::vector<double>& polar = table_.polar_rad;
    const auto count = static_cast<int>(polar.size());
    const auto above = std::upper_bound(polar.begin(), polar.end(), polar_rad) - polar.begin();
    const int first = static_cast<int>(above) - 2;
    std::vector<Node> nodes;
    for (int i = first; i < first + 4; ++i) {
      if (const auto node = node_at(i, count)) nodes.push_back(*node);
    }
    // Weights by polar angle; a polar angle occurs twice if one of its nodes is beyond a pole.
    std::vector<Row> rows;
    for (size_t i = 0; i < nodes.size(); ++i) {  // Lagrange
      double weight = 1.0;
      for (size_t k = 0; k < nodes.size(); ++k) {
        if (k == i) continue;
        weight *= (polar_rad - nodes[k].at_rad) / (nodes[i].at_rad - nodes[k].at_rad);
      }
      auto row = std::ranges::find(rows, nodes[i].index, &Row::polar);
      if (row == rows.end()) {
        rows.push_back({nodes[i].index, std::vector<double>(around_rad_.size(), 0.0)});
        row = rows.end() - 1;
      }
      add_round(around_rad + (nodes[i].opposite ? pi : 0.0), weight, row->weights);
    }
    double sum = 0.0, variance = 0.0;
    for (const Row& row : rows) {
      for (size_t i = 0; i < row.weights.size(); ++i) {
        const size_t node = table_.node(i, row.polar);
        sum += row.weights[i] * table_.torque_body_N_m[node][axis_];
        const double error = row.weights[i] * table_.torque_error_N_m[node][axis_];
        variance += error * error;
      }
    }
    return {sum, std::sqrt(variance)};
  }

 private:
  struct Node {
    double at_rad;
    size_t index;
    bool opposite;  // beyond a pole: azimuth + 180 deg
  };
  // Weights of all azimuths at one polar angle.
  struct Row {
    size_t polar;
    std::vector<double> weights;
  };

  SmoothComponent(const WrenchTable& table, std::vector<double> around, int axis)
      : table_(table), around_rad_(std::move(around)), axis_(axis) {}

  // Node i of the polar angles. Indices below 0 and from `count` are mirrored at the pole; the
  // result is empty if the table does not extend to it.
  std::optional<Node> node_at(int i, int count) const {
    const std::vector<double>& polar = table_.polar_rad;
    const bool tilt = table_.angles == WrenchTable::Angles::tilt_heading;
    const double low_pole = tilt ? 0.0 : -0.5 * pi, high_pole = low_pole + pi;
    constexpr double same = 1e-9;
    const auto at = [&](int k) { return polar[static_cast<size_t>(k)]; };
    if (i >= 0 && i < count) return Node{at(i), static_cast<size_t>(i), false};
    if (i < 0 && std::abs(at(0) - low_pole) < same && -i < count) {
      return Node{2.0 * low_pole - at(-i), static_cast<size_t>(-i), true};
    }
    const int mirrored = 2 * (count - 1) - i;
    if (i >= count && std::abs(at(count - 1) - high_pole) < same && mirrored >= 0) {
      return Node{2.0 * high_pole - at(mirrored), static_cast<size_t>(mirrored), true};
    }
    return std::nullopt;
  }

  // Adds `weight` times the trigonometric interpolation at `at_rad` to the weights of the azimuths.
  // Source: A. Zygmund, Trigonometric Series, chapter X (its Dirichlet kernels).
  void add_round(double at_rad, double weight, std::vector<double>& weights) const {
    const auto count = static_cast<double>(around_rad_.size());
    for (size_t i = 0; i < around_rad_.size(); ++i) {
      const double half = 0.5 * std::remainder(at_rad - around_rad_[i], 2.0 * pi);
      double kernel = 1.0;
      if (std::abs(half) > 1e-12) {
        kernel = std::sin(count * half) /
                 (count * (around_rad_.size() % 2 == 0 ? std::tan(half) : std::sin(half)));
      }
      weights[i] += weight * kernel;
    }
  }

  const WrenchTable& table_;
  std::vector<double> around_rad_;
  int axis_;
};

// Map of `value(distance from the centre, azimuth)` over the disc of radius `reach`.
template <typename Value>
Map disc(double reach, const Value& value) {
  Map map;
  map.width = map.height = side;
  const double edge = reach * side / (side - 1.0);  // the outermost nodes are on the rim
  map.x_low = map.y_low = -edge;
  map.x_high = map.y_high = edge;
  map.smooth = map.signed_values = true;
  map.unit = "N m";
  map.value.resize(side * side);
  map.standard_error.resize(side * side);
  parallel_for(side, 0, [&](size_t row) {
    for (size_t column = 0; column < side; ++column) {
      const double x = reach * (2.0 * static_cast<double>(column) / (side - 1.0) - 1.0);
      const double y = reach * (2.0 * static_cast<double>(row) / (side - 1.0) - 1.0);
      const double distance = std::hypot(x, y);
      const Estimate at =
          distance > reach * (1.0 + 1e-12) ? Estimate{nan, nan} : value(distance, std::atan2(y, x));
      map.value[row * side + column] = at.value;
      map.standard_error[row * side + column] = at.standard_error;
    }
  });
  return map;
}

// Map of the magnitude of the torque, from the maps "torque_x_NAME" + ending and so on. The error
// is the component of the errors along the torque.
Map size_of(const std::vector<Map>& maps, const std::string& name, const std::string& ending,
            const std::string& title) {
  std::array<const Map*, 3> parts{};
  for (size_t axis = 0; axis < 3; ++axis) {
    const std::string part = std::string("torque_") + "xyz"[axis] + "_" + name + ending;
    parts[axis] = &*std::ranges::find(maps, part, &Map::name);
  }
  Map size = *parts[0];
  size.name = "torque_size_" + name + ending;
  size.title = title;
  size.signed_values = false;
  for (size_t i = 0; i < size.value.size(); ++i) {
    const Vec3 torque(parts[0]->value[i], parts[1]->value[i], parts[2]->value[i]);
    const Vec3 error(parts[0]->standard_error[i], parts[1]->standard_error[i],
                     parts[2]->standard_error[i]);
    size.value[i] = torque.norm();
    size.standard_error[i] =
        torque.norm() > 0.0 ? torque.normalized().cwiseProduct(error).norm() : error.norm();
  }
  return size;
}

}  // namespace

std::vector<Map> polar_maps(const WrenchTable& table, const std::string& name,
                            const std::string& source) {
  // The title omits the name "body", which stands for the whole platform.
  const std::string on_part = name == "body" ? "" : " on " + name;
  const std::string of_size = "Size of the torque of " + source + on_part;
  constexpr double same = 1e-9;
  std::vector<Map> maps;
  for (int axis = 0; axis < 3; ++axis) {
    const auto component = SmoothComponent::of(table, axis);
    if (!component) return maps;
    const std::string stem = std::string("torque_") + "xyz"[axis] + "_" + name;
    const std::string title = "Torque of " + source + " about body " + "xyz"[axis] + on_part;
    if (table.angles == WrenchTable::Angles::tilt_heading) {
      if (table.polar_rad.front() > same) return maps;
      Map map = disc(table.polar_rad.back() / degree_rad, [&](double tilt_deg, double heading_rad) {
        return (*component)(tilt_deg * degree_rad, heading_rad);
      });
      map.name = stem + "_polar";
      map.title = title;
      map.x_label = "tilt towards heading 0 [deg]";
      map.y_label = "tilt towards heading 90 [deg]";
      maps.push_back(std::move(map));
      if (axis == 2) maps.push_back(size_of(maps, name, "_polar", of_size));
      continue;
    }
    const bool sphere = std::abs(table.polar_rad.front() + 0.5 * pi) < same &&
                        std::abs(table.polar_rad.back() - 0.5 * pi) < same;
    if (!sphere) return maps;
    for (const bool plus : {true, false}) {
      // In the view from −z, body x points to the left.
      Map map = disc(1.0, [&](double distance, double around_rad) {
        const double from_pole = 2.0 * std::asin(std::min(1.0, distance * std::sqrt(0.5)));
        const double elevation = 0.5 * pi - from_pole;
        return plus ? (*component)(elevation, around_rad)
                    : (*component)(-elevation, pi - around_rad);
      });
      map.name = stem + (plus ? "_from_plus_z" : "_from_minus_z");
      map.title = title + ", " + source + " from the side of " + (plus ? "+z" : "−z");
      map.x_label = plus ? "towards +x" : "towards −x";
      map.y_label = "towards +y";
      maps.push_back(std::move(map));
    }
    if (axis < 2) continue;
    for (const auto& [ending, side] : {std::pair{"_from_plus_z", "+z"}, {"_from_minus_z", "−z"}}) {
      maps.push_back(
          size_of(maps, name, ending, of_size + ", " + source + " from the side of " + side));
    }
  }
  return maps;
}

double stated_deg(double angle_rad) {
  return std::round(1e10 * angle_rad / degree_rad) / 1e10;
}

void add_components(Table& table, const std::string& stem, const std::string& unit,
                    const std::vector<Vec3>& values) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> components;
    for (const Vec3& value : values) components.push_back(value[axis]);
    table.add(stem + "_" + "xyz"[axis] + "_" + unit, components);
  }
}

namespace {

// A vector column of a WrenchTable, force or torque, with its standard error.
struct VectorColumn {
  std::string name;
  const char* unit_suffix;
  const char* unit;
  const char* of_component;  // words before the axis in a title
  const std::vector<Vec3>* value;
  const std::vector<Vec3>* error;
};

std::array<VectorColumn, 2> vector_columns(const WrenchTable& table) {
  return {{{"force", "N", "N", "Force along body ", &table.force_body_N, &table.force_error_N},
           {"torque", "N_m", "N m", "Torque about body ", &table.torque_body_N_m,
            &table.torque_error_N_m}}};
}

struct AngleNames {
  std::string polar, around;
};

AngleNames angle_names(const WrenchTable& table) {
  return table.angles == WrenchTable::Angles::tilt_heading ? AngleNames{"tilt", "heading"}
                                                           : AngleNames{"elevation", "azimuth"};
}

std::string letter(int axis) {
  return std::string(1, "xyz"[axis]);
}

Table rows(const WrenchTable& table, const std::string& name, const std::string& source) {
  const AngleNames names = angle_names(table);
  Table result = Table::of("wrench_table_" + name,
                           "Force and torque of " + source + " on " + name + ", body frame");
  for (const double around_rad : table.around_rad) {
    for (const double polar_rad : table.polar_rad) {
      result.row()
          .set(names.around + "_deg", stated_deg(around_rad))
          .set(names.polar + "_deg", stated_deg(polar_rad));
    }
  }
  for (const VectorColumn& c : vector_columns(table)) {
    add_components(result, c.name, c.unit_suffix, *c.value);
  }
  for (const VectorColumn& c : vector_columns(table)) {
    add_components(result, c.name + "_error", c.unit_suffix, *c.error);
  }
  return result;
}

// Step of an axis with equally spaced nodes; 0 otherwise.
double regular_step_rad(const std::vector<double>& axis_rad) {
  if (axis_rad.size() < 2) return 0.0;
  const double step =
      (axis_rad.back() - axis_rad.front()) / static_cast<double>(axis_rad.size() - 1);
  for (size_t i = 0; i < axis_rad.size(); ++i) {
    if (std::abs(axis_rad[i] - axis_rad.front() - static_cast<double>(i) * step) > 1e-6 * step) {
      return 0.0;
    }
  }
  return step;
}

Map component_map(const WrenchTable& table, const VectorColumn& column, int axis,
                  const std::string& name) {
  const AngleNames names = angle_names(table);
  const double half_polar_rad = 0.5 * regular_step_rad(table.polar_rad);
  const double half_around_rad = 0.5 * regular_step_rad(table.around_rad);
  Map map;
  map.name = column.name + "_" + "xyz"[axis] + "_" + name;
  map.title = column.of_component + letter(axis) + (name == "body" ? "" : " on " + name);
  map.unit = column.unit;
  // If the table covers the whole circle, its first nodes are repeated at the end of the picture.
  const size_t around_nodes = table.around_rad.size();
  const double missing_rad =
      2.0 * pi - (table.around_rad.back() - table.around_rad.front()) - 2.0 * half_around_rad;
  const size_t columns = around_nodes + (std::abs(missing_rad) < 1e-6 ? 1 : 0);
  const double last_rad =
      table.around_rad.front() + 2.0 * half_around_rad * static_cast<double>(columns - 1);
  map.width = static_cast<int>(columns);
  map.height = static_cast<int>(table.polar_rad.size());
  map.x_low = (table.around_rad.front() - half_around_rad) / degree_rad;
  map.x_high = (last_rad + half_around_rad) / degree_rad;
  map.y_low = (table.polar_rad.front() - half_polar_rad) / degree_rad;
  map.y_high = (table.polar_rad.back() + half_polar_rad) / degree_rad;
  map.x_label = names.around + " [deg]";
  map.y_label = names.polar + " [deg]";
  map.equal_scale = false;
  map.signed_values = map.smooth = true;
  for (size_t polar = 0; polar < table.polar_rad.size(); ++polar) {
    for (size_t i = 0; i < columns; ++i) {
      const size_t node = table.node(i % around_nodes, polar);
      map.value.push_back((*column.value)[node][axis]);
      map.standard_error.push_back((*column.error)[node][axis]);
    }
  }
  return map;
}

Plot component_plot(const WrenchTable& table, const VectorColumn& column, const std::string& name,
                    const std::string& source) {
  Plot plot{column.name + "_" + name,
            (column.name == "force" ? "Force of " : "Torque of ") + source + " on " + name +
                ", body frame",
            angle_names(table).polar + " [deg]", column.name + " [" + column.unit + "]"};
  for (int axis = 0; axis < 3; ++axis) {
    Plot::Curve curve{letter(axis)};
    for (size_t polar = 0; polar < table.polar_rad.size(); ++polar) {
      curve.x.push_back(stated_deg(table.polar_rad[polar]));
      curve.y.push_back((*column.value)[polar][axis]);
      curve.y_error.push_back((*column.error)[polar][axis]);
    }
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

// The largest magnitude of a column, with the error along that vector.
Quantity largest(const VectorColumn& column, const std::string& name) {
  Estimate longest;
  for (size_t i = 0; i < column.value->size(); ++i) {
    const Vec3& value = (*column.value)[i];
    if (!(value.norm() > longest.value)) continue;
    longest = {value.norm(), value.normalized().cwiseProduct((*column.error)[i]).norm()};
  }
  return {"largest_" + column.name + "_" + name + "_" + column.unit_suffix, longest};
}

}  // namespace

Product wrench_table_product(const WrenchTable& table, const std::string& name,
                             const std::string& source) {
  Product product;
  product.tables.push_back(rows(table, name, source));
  const bool regular =
      regular_step_rad(table.polar_rad) > 0.0 && regular_step_rad(table.around_rad) > 0.0;
  for (const VectorColumn& column : vector_columns(table)) {
    product.quantities.push_back(largest(column, name));
    if (table.around_rad.size() == 1)
      product.plots.push_back(component_plot(table, column, name, source));
    for (int axis = 0; axis < 3 && regular; ++axis) {
      product.maps.push_back(component_map(table, column, axis, name));
    }
  }
  for (Map& map : polar_maps(table, name, source)) product.maps.push_back(std::move(map));
  return product;
}

}  // namespace photorque
