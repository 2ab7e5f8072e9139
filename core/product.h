// Results as plain data for the writers: estimates, maps, tables, curves, bars.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace photorque {

// A number that was estimated. `standard_error` is one standard deviation of `value`, in the same
// unit; 0 for exact values.
struct Estimate {
  double value = 0.0;
  double standard_error = 0.0;
};

// Mean and its standard error from independent, identically distributed replicates, at least two.
// With R replicates the error itself is uncertain by about 1/√(2(R−1)).
// Source: W. G. Cochran, Sampling Techniques, 3rd ed., eq. 2.20 (without finite correction).
Estimate estimate_from_replicates(std::span<const double> replicates);

// A main result. `name` ends in its unit: "power_on_array_W".
struct Quantity {
  std::string name;
  Estimate estimate;
};

// A scalar field on a regular grid. Row iy, column ix is at index iy·width + ix; x and y rise with
// the index. Values are bin averages; `standard_error` has the same size or is empty (exact).
struct Map {
  std::string name;   // file stem: "irradiance_solar_array"
  std::string title;  // as printed: "Irradiance on solar_array"
  std::string unit;   // "W/m²"
  int width = 0;
  int height = 0;
  double x_low = 0, x_high = 1, y_low = 0, y_high = 1;  // outer edges of the grid
  std::string x_label = "x [m]", y_label = "y [m]";
  bool signed_values = false;  // draw with a diverging colour map centred on zero
  std::vector<double> value = {};
  std::vector<double> standard_error = {};
  bool equal_scale = true;  // x and y have the same unit and are drawn to the same scale
  // Values are those of a smooth field at the middles of the bins. The map is then drawn
  // interpolated, with contour lines.
  bool smooth = false;
  // Weight of each value in the mean (surface area of each bin); empty: equal weights.
  std::vector<double> weight = {};
};

// Columns of equal length; the name of a column ends in its unit. Text columns (labels) come first.
// Built by column name:
//   Table table = Table::of("maxima", "Local maxima of the power", {"voltage_V", "power_W"});
//   table.row().set("voltage_V", 31.2).set("power_W", 94.0);
// If a table is created without columns, its first row defines them, in the order of set().
struct Table {
  std::string name;
  std::string title;
  struct Column {
    std::string name;
    std::vector<double> values = {};
    std::vector<std::string> texts = {};  // used instead of values when not empty
    size_t size() const { return texts.empty() ? values.size() : texts.size(); }
  };
  std::vector<Column> columns;

  // An empty table with these columns in this order.
  static Table of(std::string name, std::string title,
                  const std::vector<std::string>& column_names = {});

  // Appends a column. Throws NumericalError if the name exists or, except for the first column, if
  // the length differs from that of the first column.
  Table& add(std::string column_name, std::vector<double> values);
  Table& add(std::string column_name, std::vector<std::string> texts);

  // One row of the table, filled in column by column. Throws NumericalError for a column that the
  // table does not have, that is set twice, or that was left out of an earlier row.
  class Row {
   public:
    Row& set(std::string_view column_name, double value);
    Row& set(std::string_view column_name, std::string text);
    Row& set(std::string_view column_name, const char* text);

   private:
    friend struct Table;
    Row(Table& table, size_t index) : table_(&table), index_(index) {}
    Column& cell_column(std::string_view column_name) const;
    Table* table_;
    size_t index_;
  };
  // Appends a row.
  Row row();

  // The column of this name; null if there is none.
  const Column* find(std::string_view column_name) const;
  // The column of this name. Throws NumericalError if there is none.
  const Column& column(std::string_view column_name) const;
  Column& column(std::string_view column_name);
};

// Curves in one pair of axes, or in several stacked ones that share x (time histories).
struct Plot {
  std::string name;
  std::string title;
  std::string x_label, y_label;
  // Colour of a curve: the next one of the palette, or one with the same meaning on a whole page.
  enum class Colour { in_order, blue, vermilion, green, grey };
  struct Curve {
    std::string label = {};
    std::vector<double> x = {}, y = {};
    std::vector<double> y_error = {};  // one standard error; empty: none drawn
    bool markers = false;              // points instead of a line
    bool bars = false;                 // bars 0.8 wide from zero instead; no errors drawn
    bool dots = false;                 // small points without errors, for thousands of readings
    bool dashed = false;
    Colour colour = Colour::in_order;
    double width = 1.6;  // width of the line in points; dots are as wide as two lines
  };
  std::vector<Curve> curves = {};
  bool x_log = false, y_log = false;
  struct Panel {
    std::string y_label;
    std::vector<Curve> curves = {};
    bool y_log = false;
    std::vector<double> levels = {};  // dotted horizontal lines at these y
    // The y axis fits the central 99.6 % of the values, so that one outlier does not flatten the
    // rest.
    bool robust_range = false;
  };
  std::vector<Panel> below = {};    // further axes under the first
  std::vector<double> levels = {};  // for the first axes; see Panel::levels
  bool robust_range = false;        // for the first axes; see Panel::robust_range
  struct Interval {
    double from = 0.0, to = 0.0;
  };
  std::vector<Interval> shaded = {};  // intervals of x, behind the curves of all axes
  std::string shaded_label = {};      // in the first interval that has room for it
};

// Horizontal bars from zero, each with its number; negative ones to the left.
struct BarChart {
  std::string name;
  std::string title;
  std::string x_label;  // quantity of the lengths, with the unit in brackets
  struct Bar {
    std::string label;  // left of the bar
    double value = 0.0;
    std::string note = {};     // right of it
    bool highlighted = false;  // stands out by colour and weight
  };
  std::vector<Bar> bars;
};

// All results of one step of the program.
struct Product {
  std::vector<Quantity> quantities;
  std::vector<Map> maps;
  std::vector<Table> tables;
  std::vector<Plot> plots;
};

// The quantity or table of this name; null if there is none.
const Quantity* find_quantity(const Product& product, std::string_view name);
const Table* find_table(const Product& product, std::string_view name);
// Throws NumericalError if there is none.
const Table& table_named(const Product& product, std::string_view name);

}  // namespace photorque
