#include "photovoltaics/array/array.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "core/errors.h"
#include "photovoltaics/cell/table.h"
#include "raytrace/receiver.h"

namespace photorque {
namespace {

constexpr int curve_intervals = 200;

// Light and photocurrent of the cells.
struct CellLight {
  std::vector<double> incident_W;  // per cell
  std::vector<double> entering_W;  // incident_W times the relative transmission at its angles
  std::vector<double> current_A;
};

// The mean bins of an ArrayLight.
struct LightBins {
  std::vector<double> power_W;
  std::vector<double> entry_W;  // may be empty
};

// Properties that do not depend on the light.
struct PreparedArray {
  const ArrayDesign& design;
  std::vector<double> responsivity_A_W;  // per band
  CellCover cover;
  std::vector<double> area_m2 = {};
  double total_area_m2 = 0.0;
  double temperature_K = 0.0;            // temperature of the members below
  std::vector<double> factor_A_W = {};   // per band
  std::vector<double> cell_factor = {};  // per cell, relative to a cell without override
  CellTables tables = {};

  // Sets the temperature; the tables of the cells are not computed.
  void warm_to(double kelvin);
  ArrayCurve curve(const std::vector<double>& photocurrents_A) const {
    return {design.wiring, tables, photocurrents_A};
  }
  CellLight light(const LightBins& bins) const;
};

// The fraction of the light that enters, per cell and band. A cell without sampled rays gets the
// fraction of the whole array.
std::vector<double> entering_fraction(const CellCover& cover, size_t bands,
                                      std::span<const double> entry_W) {
  std::vector<double> fraction(cover.cells() * bands, 1.0);
  if (entry_W.empty()) return fraction;
  const std::vector<double> all = cover.gather(entry_W.first(entry_W.size() / 2));
  const std::vector<double> entering = cover.gather(entry_W.subspan(entry_W.size() / 2));
  for (size_t band = 0; band < bands; ++band) {
    double all_W = 0.0, entering_W = 0.0;
    for (size_t i = band; i < all.size(); i += bands) {
      all_W += all[i];
      entering_W += entering[i];
    }
    const double mean = all_W > 0.0 ? entering_W / all_W : 1.0;
    for (size_t i = band; i < all.size(); i += bands) {
      fraction[i] = all[i] > 0.0 ? entering[i] / all[i] : mean;
    }
  }
  return fraction;
}

CellLight PreparedArray::light(const LightBins& bins) const {
  const size_t cells = cover.cells(), bands = factor_A_W.size();
  const std::vector<double> power_W = cover.gather(bins.power_W);
  const std::vector<double> fraction = entering_fraction(cover, bands, bins.entry_W);
  CellLight light{std::vector<double>(cells, 0.0), std::vector<double>(cells, 0.0),
                  std::vector<double>(cells, 0.0)};
  for (size_t i = 0; i < power_W.size(); ++i) {
    const size_t cell = i / bands;
    const double entering_W = power_W[i] * fraction[i];
    light.incident_W[cell] += power_W[i];
    light.entering_W[cell] += entering_W;
    light.current_A[cell] += entering_W * factor_A_W[i % bands] * cell_factor[cell];
  }
  return light;
}

CellCover cover_of(const ArrayDesign& design, const ArrayLight& light) {
  if (design.places) return {light, design.places->parts};
  std::vector<std::vector<BinPart>> parts;
  for (const CellRectangle& cell :
       cell_rectangles(light.grid, design.columns, design.rows, design.gap_m, design.margin_m)) {
    parts.push_back(parts_of_rectangle(cell, light.grid));
  }
  return {light, parts};
}

// Prepares the array for its light; the tables of the cells are not computed.
PreparedArray prepare_light(const ArrayDesign& design, const ArrayLight& light,
                            std::span<const double> responsivity_A_W) {
  if (responsivity_A_W.size() < static_cast<size_t>(light.bands)) {
    throw InputError({}, "array", std::to_string(responsivity_A_W.size()) + " responsivities",
                     "one per band");
  }
  const auto used = responsivity_A_W.first(static_cast<size_t>(light.bands));
  PreparedArray array{design, {used.begin(), used.end()}, cover_of(design, light)};
  for (size_t i = 0; i < array.cover.cells(); ++i) {
    array.area_m2.push_back(array.cover.area_m2(i));
    array.total_area_m2 += array.area_m2.back();
    if (!(array.area_m2.back() > 0)) {
      throw InputError({}, "array", "cell " + std::to_string(i) + " beside the surface",
                       "cells on the receiver");
    }
  }
  array.warm_to(design.temperature_K);
  return array;
}

void PreparedArray::warm_to(double kelvin) {
  temperature_K = kelvin;
  const double warmth = photocurrent_factor(design.cell, kelvin);
  factor_A_W = responsivity_A_W;
  for (double& factor : factor_A_W) factor *= warmth;
  cell_factor.assign(cover.cells(), 1.0);
  for (const CellOverride& one : design.overrides) {
    cell_factor[static_cast<size_t>(one.index)] =
        one.photocurrent_factor * photocurrent_factor(one.model, kelvin) / warmth;
  }
  tables.clear();
}

// The diode law of each cell; cells of equal area share one. It is a table, unless `once` (a single
// maximum of the power) makes the direct computation faster.
CellTables laws_at(const ArrayDesign& design, std::span<const double> cell_area_m2,
                   double largest_photocurrent_A, double temperature_K, bool once = false) {
  // Number of cells for which one maximum without a table takes as long as computing the table.
  constexpr size_t few_cells = 400;
  const bool tabulated = !once || cell_area_m2.size() > few_cells;
  std::vector<std::pair<double, std::shared_ptr<const DiodeVoltageLaw>>> known;
  const auto law_of = [&](const CellModel& model,
                          double area_m2) -> std::shared_ptr<const DiodeVoltageLaw> {
    const CellParameters parameters = parameters_at(model, area_m2, temperature_K);
    if (!tabulated) return diode_voltage_law(parameters);
    return std::make_shared<const DiodeVoltageTable>(CellCurve(parameters),
                                                     std::max(2.0 * largest_photocurrent_A, 1e-9));
  };
  CellTables tables;
  for (size_t i = 0; i < cell_area_m2.size(); ++i) {
    const double area_m2 = cell_area_m2[i];
    if (const CellOverride* one = design.override_of(i)) {
      tables.push_back(law_of(one->model, area_m2));
      continue;
    }
    // Areas that differ only by the rounding of single-precision coordinates are equal.
    constexpr double rounding = 1e-6;
    auto same = std::ranges::find_if(known, [&](const auto& pair) {
      return std::abs(pair.first - area_m2) <= rounding * area_m2;
    });
    if (same == known.end()) {
      known.emplace_back(area_m2, law_of(design.cell, area_m2));
      same = known.end() - 1;
    }
    tables.push_back(same->second);
  }
  return tables;
}

void prepare_tables(PreparedArray& array, const LightBins& bins, bool once = false) {
  const std::vector<double> current_A = array.light(bins).current_A;
  array.tables =
      laws_at(array.design, array.area_m2, std::ranges::max(current_A), array.temperature_K, once);
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// Results with a standard error.
namespace item {
enum Index : size_t {
  power,
  voltage,
  current,
  light,
  entering,
  alone,
  efficiency,
  cells,
  mismatch,
  temperature,
  count
};
}  // namespace item
using Headline = std::array<double, item::count>;
using Estimates = std::array<Estimate, item::count>;

Headline headline(const PreparedArray& array, const LightBins& bins) {
  const CellLight light = array.light(bins);
  const ArrayPoint best = array.curve(light.current_A).maximum_power();
  const double light_W = sum_of(light.incident_W);
  double alone_W = 0.0;
  for (size_t i = 0; i < light.current_A.size(); ++i) {
    const auto law = law_in_light(array.tables[i], light.current_A[i]);
    alone_W += law->curve().maximum_power(light.current_A[i]).power_W();
  }
  const double power_W = best.power_W();
  return {power_W,
          best.voltage_V,
          best.current_A,
          light_W,
          sum_of(light.entering_W),
          alone_W,
          light_W > 0 ? power_W / light_W : 0.0,
          light_W > 0 ? alone_W / light_W : 0.0,
          alone_W > 0 ? 1.0 - power_W / alone_W : 0.0,
          array.temperature_K};
}

// The steady-state temperature of the cells in this light. The photocurrents at the temperature of
// the array are converted to other temperatures.
double steady_temperature_K(const PreparedArray& array, const LightBins& bins) {
  const ArrayDesign& design = array.design;
  const CellLight light = array.light(bins);
  const auto electric_W_m2 = [&](double kelvin) {
    const std::vector<double> current_A =
        warmed(design, light.current_A, array.temperature_K, kelvin);
    const CellTables tables =
        laws_at(design, array.area_m2, std::ranges::max(current_A), kelvin, true);
    return ArrayCurve(design.wiring, tables, current_A).maximum_power().power_W() /
           array.total_area_m2;
  };
  return CellPlate(*design.heat, array.total_area_m2)
      .steady_K(sum_of(light.incident_W) / array.total_area_m2, electric_W_m2);
}

// Derivative of the results with respect to the cell temperature, in the same light. The array is
// unchanged afterwards.
Headline slope_of_headline(PreparedArray& array, const LightBins& bins) {
  const double kelvin = array.temperature_K;
  const double step_K = 1e-3 * kelvin;
  const auto at = [&](double other_K) {
    array.warm_to(other_K);
    prepare_tables(array, bins, true);
    return headline(array, bins);
  };
  Headline slope = at(kelvin + step_K);
  const Headline colder = at(kelvin - step_K);
  for (size_t k = 0; k < item::count; ++k) {
    slope[k] = (slope[k] - colder[k]) / (2.0 * step_K);
  }
  array.warm_to(kelvin);
  prepare_tables(array, bins);
  return slope;
}

// The mean of all replicates except one, at least zero: noise can make it negative.
std::vector<double> mean_without(int replicate, const BinSums& sums, std::span<const double> mean) {
  const std::span<const double> one = sums.of(replicate);
  const double count = sums.replicates;
  std::vector<double> others(mean.size());
  for (size_t b = 0; b < mean.size(); ++b) {
    others[b] = std::max(0.0, (count * mean[b] - one[b]) / (count - 1.0));
  }
  return others;
}

// The light without each replicate in turn.
std::vector<LightBins> leave_one_out(const ArrayLight& light, const LightBins& mean) {
  std::vector<LightBins> all;
  for (int r = 0; r < light.power_W.replicates; ++r) {
    all.push_back({mean_without(r, light.power_W, mean.power_W), {}});
    if (light.entry.bins > 0) all.back().entry_W = mean_without(r, light.entry, mean.entry_W);
  }
  return all;
}

// Tukey's jackknife error of a number from its values without each replicate in turn.
double jackknife_error(std::span<const double> without) {
  return static_cast<double>(without.size() - 1) * estimate_from_replicates(without).standard_error;
}

// The values at the mean of all replicates, with Tukey's jackknife errors. The bias is of second
// order in the error and not removed, so that the results agree with the printed curve. In the
// steady state, the temperature follows the light to first order.
Estimates estimate(const PreparedArray& array, const ArrayLight& light, const LightBins& mean,
                   const Headline& slope) {
  const Headline value = headline(array, mean);
  Estimates estimates{};
  for (size_t k = 0; k < item::count; ++k) estimates[k].value = value[k];
  if (light.power_W.replicates < 2) return estimates;
  double absorptance = 0.0, W_per_K = 0.0;
  if (array.design.heat) {
    const CellPlate plate(*array.design.heat, array.total_area_m2);
    absorptance = array.design.heat->absorptance;
    W_per_K =
        array.total_area_m2 * plate.loss_slope_W_m2_K(array.temperature_K) + slope[item::power];
  }
  const auto warmer_K = [&](double light_W, double power_W) {
    return W_per_K > 0.0 ? (absorptance * light_W - power_W) / W_per_K : 0.0;
  };
  std::array<std::vector<double>, item::count> without;
  for (const LightBins& others : leave_one_out(light, mean)) {
    const Headline one = headline(array, others);
    const double change_K =
        warmer_K(one[item::light] - value[item::light], one[item::power] - value[item::power]);
    for (size_t k = 0; k < item::count; ++k) without[k].push_back(one[k] + change_K * slope[k]);
  }
  const double common = light.power_W.common_error();
  for (size_t k = 0; k < item::count; ++k) {
    estimates[k] = with_common_error({value[k], jackknife_error(without[k])}, common);
  }
  // With all light, the power changes in proportion.
  estimates[item::temperature].standard_error =
      std::hypot(jackknife_error(without[item::temperature]),
                 common * warmer_K(value[item::light], value[item::power]));
  return estimates;
}

LightBins mean_light(const ArrayLight& light) {
  LightBins bins{mean_bins(light.power_W), {}};
  if (light.entry.bins == 0) return bins;
  if (light.entry.bins != 2 * light.power_W.bins ||
      light.entry.replicates != light.power_W.replicates) {
    throw InputError({}, "array", "light and its way into the cells on different grids",
                     "one grid and as many replicates");
  }
  bins.entry_W = mean_bins(light.entry);
  return bins;
}

}  // namespace

std::vector<double> warmed(const ArrayDesign& design, std::vector<double> photocurrent_A,
                           double from_K, double to_K) {
  const auto warmth = [&](const CellModel& model) {
    return photocurrent_factor(model, to_K) / photocurrent_factor(model, from_K);
  };
  const double of_most = warmth(design.cell);
  for (size_t i = 0; i < photocurrent_A.size(); ++i) {
    const CellOverride* one = design.override_of(i);
    photocurrent_A[i] *= one != nullptr ? warmth(one->model) : of_most;
  }
  return photocurrent_A;
}

CellTables cell_tables(const ArrayDesign& design, std::span<const double> cell_area_m2,
                       double largest_photocurrent_A) {
  return laws_at(design, cell_area_m2, largest_photocurrent_A, design.temperature_K);
}

CellCurrents cell_currents(const ArrayDesign& design, const ArrayLight& light,
                           std::span<const double> responsivity_A_W) {
  const PreparedArray array = prepare_light(design, light, responsivity_A_W);
  const LightBins mean = mean_light(light);
  const CellLight cells = array.light(mean);
  CellCurrents result{cells.current_A,
                      std::vector<double>(cells.current_A.size(), 0.0),
                      {sum_of(cells.incident_W), 0.0},
                      array.area_m2};
  if (light.power_W.replicates < 2) return result;
  const size_t count = cells.current_A.size();
  std::vector<std::vector<double>> current_A(count);  // per cell, without each replicate in turn
  std::vector<double> incident_W;
  for (const LightBins& others : leave_one_out(light, mean)) {
    const CellLight one = array.light(others);
    incident_W.push_back(sum_of(one.incident_W));
    for (size_t i = 0; i < count; ++i) current_A[i].push_back(one.current_A[i]);
  }
  const auto error = [&](double value, std::span<const double> without) {
    const Estimate estimate{value, jackknife_error(without)};
    return with_common_error(estimate, light.power_W.common_error()).standard_error;
  };
  for (size_t i = 0; i < count; ++i) {
    result.photocurrent_error_A[i] = error(cells.current_A[i], current_A[i]);
  }
  result.power_on_cells_W.standard_error = error(result.power_on_cells_W.value, incident_W);
  return result;
}

ArrayResult evaluate_array(const ArrayDesign& design, const ArrayLight& light,
                           std::span<const double> responsivity_A_W) {
  const LightBins mean = mean_light(light);
  PreparedArray array = prepare_light(design, light, responsivity_A_W);
  CellLight cells = array.light(mean);
  for (size_t i = 0; i < cells.current_A.size(); ++i) {
    if (std::isfinite(cells.current_A[i])) continue;
    throw NumericalError("the light on cell " + std::to_string(i) + " is no finite number");
  }
  if (design.heat) array.warm_to(steady_temperature_K(array, mean));
  const Headline slope = slope_of_headline(array, mean);
  const Estimates estimates = estimate(array, light, mean, slope);
  ArrayResult result;
  result.power_W = estimates[item::power];
  result.voltage_V = estimates[item::voltage];
  result.current_A = estimates[item::current];
  result.power_on_cells_W = estimates[item::light];
  result.power_entering_W = estimates[item::entering];
  result.entry_known = light.entry.bins > 0;
  result.sum_of_cells_W = estimates[item::alone];
  result.efficiency = estimates[item::efficiency];
  result.efficiency_of_cells = estimates[item::cells];
  result.mismatch_loss = estimates[item::mismatch];
  result.cell_area_m2 = array.area_m2;
  if (design.places) result.cell_centre_m = design.places->centres;
  result.area_of_cells_m2 = array.total_area_m2;
  result.temperature_K = estimates[item::temperature];
  result.power_per_K_W = slope[item::power];
  cells = array.light(mean);  // at the temperature of the array
  result.cell_light_W = std::move(cells.incident_W);
  result.cell_photocurrent_A = std::move(cells.current_A);
  const ArrayCurve curve = array.curve(result.cell_photocurrent_A);
  const ArrayCurve::Scan scan = curve.scan(curve_intervals);
  result.maxima = scan.maxima;
  result.curve = scan.points;
  result.cells = curve.cells_at(result.voltage_V.value);
  result.columns = design.columns;
  result.rows = design.rows;
  return result;
}

}  // namespace photorque
