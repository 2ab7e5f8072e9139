#include "receivers/wrench/table_product.h"

#include <cmath>

#include "core/constants.h"
#include "receivers/wrench/polar_maps.h"

namespace photorque {

double stated_deg(double angle_rad) {
  return std::round(1e10 * angle_rad / degree_rad) / 1e10;
}

namespace {

// One of the four vector columns of a WrenchTable.
struct VectorColumn {
  const char* name;
  const char* unit_suffix;
  const char* unit;
  const std::vector<Vec3>* value;
  const std::vector<Vec3>* error;
};

std::array<VectorColumn, 2> vector_columns(const WrenchTable& table) {
  return {{{"force", "N", "N", &table.force_body_N, &table.force_error_N},
           {"torque", "N_m", "N m", &table.torque_body_N_m, &table.torque_error_N_m}}};
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

Table rows(const WrenchTable& table, const std::string& name) {
  const AngleNames names = angle_names(table);
  Table result =
      Table::of("wrench_table_" + name, "Force and torque of light on " + name + ", body frame",
                {names.around + "_deg", names.polar + "_deg"});
  for (const double around_rad : table.around_rad) {
    for (const double polar_rad : table.polar_rad) {
      result.row()
          .set(names.around + "_deg", stated_deg(around_rad))
          .set(names.polar + "_deg", stated_deg(polar_rad));
    }
  }
  const auto add = [&](const std::string& stem, const char* unit, const std::vector<Vec3>& values) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> components;
      for (const Vec3& value : values) components.push_back(value[axis]);
      result.add(stem + "_" + letter(axis) + "_" + unit, components);
    }
  };
  for (const VectorColumn& c : vector_columns(table)) add(c.name, c.unit_suffix, *c.value);
  for (const VectorColumn& c : vector_columns(table)) {
    add(c.name + std::string("_error"), c.unit_suffix, *c.error);
  }
  return result;
}

// The step of an axis whose nodes are evenly spaced, else 0.
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
  map.name = column.name + ("_" + letter(axis)) + "_" + name;
  map.title = (std::string(column.name) == "force" ? "Force along " : "Torque about ") +
              ("body " + letter(axis)) + (name == "body" ? "" : " on " + name);
  map.unit = column.unit;
  // Where the table goes all the way round, its first nodes once more close the picture.
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

Plot component_plot(const WrenchTable& table, const VectorColumn& column, const std::string& name) {
  Plot plot;
  plot.name = std::string(column.name) + "_" + name;
  plot.title =
      (std::string(column.name) == "force" ? "Force of light on " : "Torque of light on ") + name +
      ", body frame";
  plot.x_label = angle_names(table).polar + " [deg]";
  plot.y_label = std::string(column.name) + " [" + column.unit + "]";
  for (int axis = 0; axis < 3; ++axis) {
    Plot::Curve curve;
    curve.label = letter(axis);
    for (size_t polar = 0; polar < table.polar_rad.size(); ++polar) {
      curve.x.push_back(stated_deg(table.polar_rad[polar]));
      curve.y.push_back((*column.value)[polar][axis]);
      curve.y_error.push_back((*column.error)[polar][axis]);
    }
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

// The longest vector of a column.
Quantity largest(const VectorColumn& column, const std::string& name) {
  Estimate longest;
  for (size_t i = 0; i < column.value->size(); ++i) {
    const Vec3& value = (*column.value)[i];
    if (!(value.norm() > longest.value)) continue;
    longest = {value.norm(), value.normalized().cwiseProduct((*column.error)[i]).norm()};
  }
  const std::string unit = std::string(column.name) == "force" ? "N" : "N_m";
  return {std::string("largest_") + column.name + "_" + name + "_" + unit, longest};
}

}  // namespace

Product wrench_table_product(const WrenchTable& table, const std::string& name) {
  Product product;
  product.tables.push_back(rows(table, name));
  const bool regular =
      regular_step_rad(table.polar_rad) > 0.0 && regular_step_rad(table.around_rad) > 0.0;
  for (const VectorColumn& column : vector_columns(table)) {
    product.quantities.push_back(largest(column, name));
    if (table.around_rad.size() == 1) product.plots.push_back(component_plot(table, column, name));
    for (int axis = 0; axis < 3 && regular; ++axis) {
      product.maps.push_back(component_map(table, column, axis, name));
    }
  }
  for (Map& map : polar_maps(table, name)) product.maps.push_back(std::move(map));
  return product;
}

}  // namespace photorque
