#include "receivers/photovoltaic_array.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "core/errors.h"
#include "receivers/jackknife.h"

namespace photorque {
namespace {

constexpr int curve_intervals = 200;

// Everything that does not depend on the light.
struct PreparedArray {
  const ArrayDesign& design;
  CellCover cover;
  std::vector<double> area_m2;
  std::vector<double> factor_A_W;  // per band, temperature included
  CellTables tables;

  ArrayCurve curve(const std::vector<double>& photocurrents_A) const {
    return {design.wiring, tables, photocurrents_A};
  }
};

PreparedArray prepare(const ArrayDesign& design, const ArrayLight& light,
                      std::span<const double> responsivity_A_W, std::span<const double> bins_W) {
  if (responsivity_A_W.size() < static_cast<size_t>(light.bands)) {
    throw InputError({}, "array", std::to_string(responsivity_A_W.size()) + " responsivities",
                     "one per band");
  }
  const auto rectangles =
      cell_rectangles(light, design.columns, design.rows, design.gap_m, design.margin_m);
  PreparedArray array{design, CellCover(light, rectangles), {}, {}, {}};
  for (size_t i = 0; i < array.cover.cells(); ++i) {
    array.area_m2.push_back(array.cover.area_m2(i));
    if (!(array.area_m2.back() > 0)) {
      throw InputError({}, "array", "cell " + std::to_string(i) + " beside the surface",
                       "cells on the receiver");
    }
  }
  const double warmth = photocurrent_factor(design.cell, design.temperature_K);
  for (const double r : responsivity_A_W) array.factor_A_W.push_back(r * warmth);
  const std::vector<double> currents = array.cover.gather(bins_W, array.factor_A_W);
  array.tables = cell_tables(design, array.area_m2, std::ranges::max(currents));
  return array;
}

// What gets a standard error.
struct Headline {
  enum Item { power, voltage, current, light, alone, efficiency, mismatch, count };
  std::array<double, count> value{};
};
using Estimates = std::array<Estimate, Headline::count>;

Headline headline(const PreparedArray& array, std::span<const double> bins_W) {
  const std::vector<double> currents = array.cover.gather(bins_W, array.factor_A_W);
  const ArrayPoint best = array.curve(currents).maximum_power();
  const std::vector<double> ones(array.factor_A_W.size(), 1.0);
  double light_W = 0.0, alone_W = 0.0;
  for (const double power : array.cover.gather(bins_W, ones)) light_W += power;
  for (size_t i = 0; i < currents.size(); ++i) {
    alone_W += array.tables[i]->curve().maximum_power(currents[i]).power_W();
  }
  const double power_W = best.power_W();
  return {{power_W, best.voltage_V, best.current_A, light_W, alone_W,
           light_W > 0 ? power_W / light_W : 0.0, alone_W > 0 ? 1.0 - power_W / alone_W : 0.0}};
}

// The values at the mean of all replicates, with Tukey's errors. The bias is left in, so that the
// headline is the maximum of the curve that is printed; it is of second order in the error.
Estimates estimate(const PreparedArray& array, const BinSums& sums) {
  const std::vector<double> mean = mean_bins(sums);
  const Headline value = headline(array, mean);
  Estimates estimates{};
  for (size_t k = 0; k < Headline::count; ++k) estimates[k].value = value.value[k];
  const double count = sums.replicates;
  if (sums.replicates < 2) return estimates;
  std::vector<Headline> without;
  for (int r = 0; r < sums.replicates; ++r) {
    const std::span<const double> one = sums.of(r);
    std::vector<double> others(mean.size());
    for (size_t b = 0; b < mean.size(); ++b) {
      others[b] = std::max(0.0, (count * mean[b] - one[b]) / (count - 1.0));
    }
    without.push_back(headline(array, others));
  }
  for (size_t k = 0; k < Headline::count; ++k) {
    double average = 0.0, squares = 0.0;
    for (const Headline& h : without) average += h.value[k] / count;
    for (const Headline& h : without) {
      squares += (h.value[k] - average) * (h.value[k] - average);
    }
    estimates[k].standard_error = std::sqrt((count - 1.0) / count * squares);
    estimates[k] = with_common_error(estimates[k], sums.common_error);
  }
  return estimates;
}

}  // namespace

CellTables cell_tables(const ArrayDesign& design, std::span<const double> cell_area_m2,
                       double largest_photocurrent_A) {
  std::vector<std::pair<double, std::shared_ptr<const DiodeVoltageTable>>> known;
  CellTables tables;
  for (const double area_m2 : cell_area_m2) {
    // Areas that differ by rounding alone are one.
    auto same = std::ranges::find_if(
        known, [&](const auto& pair) { return std::abs(pair.first - area_m2) <= 1e-12 * area_m2; });
    if (same == known.end()) {
      const CellCurve curve(parameters_at(design.cell, area_m2, design.temperature_K));
      known.emplace_back(area_m2, std::make_shared<const DiodeVoltageTable>(
                                      curve, std::max(2.0 * largest_photocurrent_A, 1e-9)));
      same = known.end() - 1;
    }
    tables.push_back(same->second);
  }
  return tables;
}

ArrayResult evaluate_array(const ArrayDesign& design, const ArrayLight& light,
                           std::span<const double> responsivity_A_W) {
  const std::vector<double> mean = mean_bins(light.power_W);
  const PreparedArray array = prepare(design, light, responsivity_A_W, mean);
  const Estimates estimates = estimate(array, light.power_W);
  ArrayResult result;
  result.power_W = estimates[Headline::power];
  result.voltage_V = estimates[Headline::voltage];
  result.current_A = estimates[Headline::current];
  result.power_on_cells_W = estimates[Headline::light];
  result.sum_of_cells_W = estimates[Headline::alone];
  result.efficiency = estimates[Headline::efficiency];
  result.mismatch_loss = estimates[Headline::mismatch];
  result.cell_area_m2 = array.area_m2;
  for (const double area_m2 : array.area_m2) result.area_of_cells_m2 += area_m2;
  result.cell_light_W = array.cover.gather(mean, std::vector<double>(array.factor_A_W.size(), 1.0));
  result.cell_photocurrent_A = array.cover.gather(mean, array.factor_A_W);
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
