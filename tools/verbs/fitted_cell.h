// Input of `fit-cell`; the fitted cell as text, table and picture.
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
  // Curves with light and temperature, where they are not repeats.
  std::vector<CurveAt> conditions;
  std::vector<std::string> names;  // of the sweeps
  std::vector<std::string> notes;  // parts that were left out
  std::optional<ShuntLaw> shunt_law;
  std::vector<RatedPoint> datasheet;
  std::optional<ListedModule> module;
  TemperatureSlopes slopes;
  RatedTolerance tolerance;
  SweepNoise noise;
  int cells_in_series = 1;
  int substrings = 0;  // 0: even light
  double temperature_K = 298.15;
  bool is_density = false;  // the currents are those of 1 cm²

  // n V_t of the whole device over the ideality of one of its cells, at that temperature.
  double thermal_V() const;
};

// A figure of a fit. A limit (95 %, one-sided) replaces a number that the data do not determine;
// its name states it: "shunt_above_ohm".
struct CellRow {
  enum class Is { value, lower_limit, upper_limit };
  std::string name;
  Estimate estimate;
  Is is = Is::value;
};

std::vector<CellRow> diode_rows(const SingleDiode& diode, const FitTask& task);

// The figures, and the table `parameters`.
Product parameter_product(const std::vector<CellRow>& rows);
void print_rows(const Console& console, const std::vector<CellRow>& rows);
// Parameters that are positive by their nature and come out with an error as large as themselves.
void print_undetermined(const Console& console, const std::vector<CellRow>& rows);
// Each bound on which the fit ended: key, bound, meaning.
void print_bounds(const Console& console, const std::vector<BoundReached>& bounds);
void print_key(const Console& console, const char* name, double value,
               const std::string& comment = "");
// The keys of an experiment's [array.cell_parameters] for one of the cells.
// `reference`: the shunt's change with the light.
void print_cell(const Console& console, const SingleDiode& diode, const FitTask& task,
                const CellParameters& reference = {});

// Measured points and a fitted curve, as current and as power.
void add_fit_plot(const FitTask& task, const std::vector<ArrayPoint>& fitted,
                  const std::vector<ArrayPoint>& maxima, Product& product);

}  // namespace photorque
