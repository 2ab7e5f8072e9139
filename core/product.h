// Results as plain data, on their way to a writer.
#pragma once

#include <string>
#include <vector>

#include "core/estimate.h"

namespace photorque {

// A headline figure. `name` ends in its unit: "power_on_array_W".
struct Quantity {
  std::string name;
  Estimate estimate;
};

// A scalar field on a regular grid. Row iy, column ix is at index iy·width + ix; x and y rise with
// the index. Values are bin averages; `standard_error` has the same size or is empty (exact).
struct Map {
  std::string name;   // file stem: "irradiance_solar_array"
  std::string title;  // for people: "Irradiance on solar_array"
  std::string unit;   // "W/m²"
  int width = 0;
  int height = 0;
  double x_low = 0, x_high = 1, y_low = 0, y_high = 1;  // outer edges of the grid
  std::string x_label = "x [m]", y_label = "y [m]";
  bool signed_values = false;  // draw with a diverging colour map centred on zero
  std::vector<double> value;
  std::vector<double> standard_error;
  bool equal_scale = true;  // x and y have the same unit and are drawn to the same scale
};

// Columns of equal length; the name of a column ends in its unit. Text columns (labels) come first.
struct Table {
  std::string name;
  std::string title;
  struct Column {
    std::string name;
    std::vector<double> values;
    std::vector<std::string> texts;  // used instead of values when not empty
  };
  std::vector<Column> columns;
};

// Curves in one pair of axes, or in several stacked ones that share x (time histories).
struct Plot {
  std::string name;
  std::string title;
  std::string x_label, y_label;
  struct Curve {
    std::string label;
    std::vector<double> x, y;
    std::vector<double> y_error;  // one standard error; empty: none drawn
    bool markers = false;         // points instead of a line
    bool bars = false;            // bars 0.8 wide from zero instead; no errors drawn
  };
  std::vector<Curve> curves;
  bool x_log = false, y_log = false;
  struct Panel {
    std::string y_label;
    std::vector<Curve> curves;
    bool y_log = false;
  };
  std::vector<Panel> below;  // further axes under the first
};

// Everything one step of the program found.
struct Product {
  std::vector<Quantity> quantities;
  std::vector<Map> maps;
  std::vector<Table> tables;
  std::vector<Plot> plots;
};

}  // namespace photorque
