// Input of `fit-cell`; the fitted cell as text, table and plot.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/product.h"
#include "photovoltaics/fit/conditions.h"
#include "photovoltaics/fit/fit.h"
#include "photovoltaics/fit/module_file.h"
#include "photovoltaics/network/curve.h"
#include "tools/runs/console.h"

namespace photorque {

// [fit] of an experiment.
struct FitTask {
  std::vector<std::filesystem::path> files;
  std::vector<IvSweep> sweeps;
  // Curves at different light or temperature, which are not repeats.
  std::vector<CurveAt> conditions;
  std::vector<std::string> names;  // of the sweeps
  std::vector<std::string> notes;  // omitted parts of the input
  std::optional<ShuntLaw> shunt_law;
  std::vector<RatedPoint> datasheet;
  std::optional<ListedModule> module;
  TemperatureSlopes slopes;
  std::string assumed_slopes;  // the keys of those that are not stated, with their values
  RatedTolerance tolerance;
  SweepNoise noise;
  int cells_in_series = 1;
  int substrings = 0;  // 0: uniform light
  double temperature_K = 298.15;
  bool is_density = false;  // the currents are per cm²

  // n V_t of the whole device divided by the ideality of one cell, at that temperature [V].
  double thermal_V() const;
};

// A figure of a fit. If the data do not determine a number, it is replaced by a limit (95 %,
// one-sided), whose name states this: "shunt_above_ohm". A figure that follows from an assumption
// has no error.
struct CellRow {
  enum class Is { value, lower_limit, upper_limit, assumed };
  std::string name;
  Estimate estimate;
  Is is = Is::value;
};

// Parameters of a fitted diode as figures.
std::vector<CellRow> diode_rows(const SingleDiode& diode, const FitTask& task);

// The figures, with the table `parameters`.
Product parameter_product(const std::vector<CellRow>& rows);
void print_rows(const Console& console, const std::vector<CellRow>& rows);
// Prints the positive parameters whose error is as large as their value.
void print_undetermined(const Console& console, const std::vector<CellRow>& rows);
// Prints each bound on which the fit ended: key, bound, meaning.
void print_bounds(const Console& console, const std::vector<BoundReached>& bounds);
void print_key(const Console& console, const char* name, double value,
               const std::string& comment = "");
// Prints the keys of an experiment's [array.cell_parameters] for one of the cells: those of the
// fit, also where the data determine only a limit. `reference`
// states the change of the shunt with the light.
void print_cell(const Console& console, const SingleDiode& diode, const FitTask& task,
                const CellParameters& reference = {});

// Prints the notes of the input, and the outliers that the fit left out.
void print_left_out(const Console& console, const FitTask& task,
                    const std::vector<OutlierReading>& outliers);
// Prints the law of the shunt, followed by `more`.
void print_shunt_law(const Console& console, ShuntLaw law, const std::string& more);

// Prints the cell of a library module as keys, with its listed and computed ratings.
Product list_module(const ListedModule& module, const Console& console);

// Adds measured points and a fitted curve, as current and as power.
void add_fit_plot(const FitTask& task, const std::vector<ArrayPoint>& fitted,
                  const std::vector<ArrayPoint>& maxima, Product& product);
// The maximum power point of a cell with this photocurrent.
ArrayPoint best_point(const CellCurve& cell, double light_A);
// Adds measured points and the curve of a cell with this photocurrent.
void add_cell_plot(const FitTask& task, const CellCurve& cell, double light_A, Product& product);

}  // namespace photorque
