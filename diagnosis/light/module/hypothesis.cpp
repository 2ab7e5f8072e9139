#include "diagnosis/light/module/fit.h"

#include <algorithm>
#include <cmath>

namespace photorque {
namespace {

using X = std::span<const double>;

inference::Parameter wide(const std::string& name, double mean, double sigma, double low,
                          double high) {
  return {name, "", mean, mean, sigma, low, high};
}

std::vector<int> counts_up_to(int most) {
  std::vector<int> counts;
  for (const int k : {1, 2, 3, 4, 5, 6, 8, 12, 16, 24, 32, 48}) {
    if (k <= most) counts.push_back(k);
  }
  return counts;
}

std::string cells(int count) {
  return count == 1 ? "one cell" : std::to_string(count) + " cells";
}

ModuleHypothesis shaded(int count, double alternatives) {
  ModuleHypothesis h;
  h.kind = "cell_shaded";
  h.label = "cell_shaded (" + cells(count) + ")";
  h.explanation =
      cells(count) + " of the module with less light, driven into reverse conduction by the others";
  h.count = count;
  h.alternatives = alternatives;
  // Breakdown is soft, and far from the tabulated exponent of three in cells of other makes:
  // J. W. Bishop, Solar Cells 25, 73 (1988).
  h.parameters = {wide("factor", 0.5, 0.5, 0.0, 1.0),
                  wide("breakdown_fraction", 0.0, 2.0, -8.0, std::log(7.0)),
                  wide("breakdown_V", std::log(10.0), 0.8, std::log(0.5), std::log(200.0)),
                  wide("breakdown_exponent", std::log(3.4), 0.5, 0.0, std::log(30.0))};
  for (const double factor : {0.1, 0.4, 0.75}) {
    h.starts.push_back({factor, -0.3, std::log(5.0), std::log(3.4)});
  }
  h.act = [count](X x, ModuleState& state, ModuleCell&) {
    state.shaded.push_back({count, x[0], std::exp(x[1]), -std::exp(x[2]), std::exp(x[3])});
  };
  h.numbers = {{"factor", [](X x) { return x[0]; }},
               {"breakdown_fraction", [](X x) { return std::exp(x[1]); }},
               {"breakdown_V", [](X x) { return -std::exp(x[2]); }},
               {"breakdown_exponent", [](X x) { return std::exp(x[3]); }}};
  return h;
}

// Of `count` of the substrings each has its own light.
ModuleHypothesis substrings_shaded(const ModuleDesign& design, int count, int most) {
  ModuleHypothesis h;
  h.kind = "substring_shaded";
  h.label = "substring_shaded (" + std::to_string(count) + ")";
  h.explanation = "less light on all cells of " + std::to_string(count) +
                  (count == 1 ? " bypass diode" : " bypass diodes") + " than on the others";
  h.alternatives = most;
  for (int k = 0; k < count; ++k) {
    h.parameters.push_back(wide("factor", 0.8, 0.3, 0.0, 1.0));
    h.numbers.push_back({"factor", [k](X x) { return x[static_cast<size_t>(k)]; }});
  }
  for (const double factor : {0.95, 0.8, 0.4}) {
    h.starts.emplace_back(static_cast<size_t>(count), factor);
    // Steps at different currents.
    for (size_t k = 1; k < h.starts.back().size(); ++k) h.starts.back()[k] = 0.5 + 0.5 * factor;
  }
  h.act = [count, every = design.bypass_every](X x, ModuleState& state, ModuleCell&) {
    for (int k = 0; k < count; ++k) state.shaded.push_back({every, x[static_cast<size_t>(k)]});
  };
  return h;
}

ModuleHypothesis unsteady_light() {
  ModuleHypothesis h;
  h.kind = h.label = "unsteady_light";
  h.explanation = "the light changed while the curve was taken";
  h.parameters = {wide("change", 0.0, 0.1, -0.8, 0.8), wide("bend", 0.0, 0.05, -0.4, 0.4)};
  h.act = [](X x, ModuleState& state, ModuleCell&) {
    state.light_change += x[0];
    state.light_bend += x[1];
  };
  h.numbers = {{"change", [](X x) { return x[0]; }}, {"bend", [](X x) { return x[1]; }}};
  return h;
}

ModuleHypothesis cracked(int count, double alternatives, double usual_ohm) {
  ModuleHypothesis h;
  h.kind = "cell_cracked";
  h.label = "cell_cracked (" + cells(count) + ")";
  h.explanation =
      cells(count) +
      " of the module with a part of the area cut off but for a resistance: less active "
      "area and more series resistance; a curve does not say which cells";
  h.count = count;
  h.alternatives = alternatives;
  h.parameters = {wide("fraction", 0.2, 0.3, 1e-3, 0.98),
                  wide("resistance_ohm", std::log(usual_ohm), 1.5, std::log(1e-4 * usual_ohm),
                       std::log(1e4 * usual_ohm))};
  h.starts = {{0.1, std::log(3.0 * usual_ohm)}, {0.4, std::log(2.0 * usual_ohm)}};
  h.act = [count](X x, ModuleState& state, ModuleCell&) {
    state.cracked.push_back({count, x[0], std::exp(x[1])});
  };
  h.numbers = {{"fraction", [](X x) { return x[0]; }},
               {"resistance_ohm", [](X x) { return std::exp(x[1]); }}};
  return h;
}

ModuleHypothesis of_one_number(const std::string& kind, const std::string& explanation,
                               const std::string& key, double sigma, double low, double high,
                               std::function<void(double, ModuleState&)> act,
                               std::function<double(double)> value) {
  ModuleHypothesis h;
  h.kind = h.label = kind;
  h.explanation = explanation;
  h.parameters = {wide(key, 0.0, sigma, low, high)};
  h.act = [act = std::move(act)](X x, ModuleState& state, ModuleCell&) { act(x[0], state); };
  h.numbers = {{key, [value = std::move(value)](X x) { return value(x[0]); }}};
  return h;
}

ModuleHypothesis shunted(int count, double alternatives, double usual_ohm) {
  ModuleHypothesis h = of_one_number(
      "cell_shunted", "a leak across " + cells(count), "resistance_ohm", 1.0 / usual_ohm, 0.0,
      100.0 / usual_ohm,
      [count](double x, ModuleState& state) {
        state.shunted.push_back({count, x});
      },
      [](double x) { return x > 0.0 ? 1.0 / x : 1e300; });
  h.count = count;
  h.label = "cell_shunted (" + cells(count) + ")";
  h.alternatives = alternatives;
  return h;
}

// A trap: some diode fits every smoothly falling curve.
ModuleHypothesis other_diode() {
  ModuleHypothesis h;
  h.label = "another diode (all five parameters)";
  h.is_empirical = true;
  for (const char* name : {"saturation", "ideality", "series", "shunt"}) {
    h.parameters.push_back(wide(name, 0.0, 1.0, -25.0, 25.0));
  }
  h.starts = {{0.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.5, -1.0}};
  h.act = [](X x, ModuleState&, ModuleCell& cell) {
    // With the ideality the saturation current that keeps the open-circuit voltage.
    const double open = std::log(cell.photocurrent_A / cell.saturation_A);
    const double ideality = std::exp(0.3 * x[1]);
    cell.saturation_A = cell.photocurrent_A * std::exp(-open / ideality + x[0]);
    cell.ideality *= ideality;
    cell.series_ohm *= std::exp(x[2]);
    cell.shunt_ohm *= std::exp(x[3]);
  };
  return h;
}

}  // namespace

std::vector<ModuleHypothesis> module_hypotheses(const ModuleDesign& design,
                                                const ModuleNominal& nominal) {
  std::vector<ModuleHypothesis> all(1);
  all.front().act = [](X, ModuleState&, ModuleCell&) {};
  const double usual_ohm = 0.6 / nominal.cell.photocurrent_A;  // of a cell, voltage over current
  const int under_diode = design.bypass_every > 0 ? design.bypass_every : design.cells;
  const std::vector<int> few = counts_up_to(std::min(3, std::max(1, under_diode - 1)));
  for (const int k : few) all.push_back(shaded(k, static_cast<double>(few.size())));
  const std::vector<int> some = counts_up_to(under_diode);
  for (const int k : some) all.push_back(cracked(k, static_cast<double>(some.size()), usual_ohm));
  const double of_module = design.cells * usual_ohm;
  all.push_back(of_one_number(
      "series_resistance", "more resistance in series with the module", "resistance_ohm",
      0.1 * of_module, 0.0, 10.0 * of_module,
      [](double x, ModuleState& state) { state.series_ohm += x; }, [](double x) { return x; }));
  all.push_back(of_one_number(
      "shunt", "a leak across every cell", "resistance_ohm", 0.1 / usual_ohm, 0.0, 10.0 / usual_ohm,
      [](double x, ModuleState& state) { state.shunt_S += x; },
      [](double x) { return x > 0.0 ? 1.0 / x : 1e300; }));
  const std::vector<int> leaking = counts_up_to(std::max(1, design.cells - 1));
  for (const int k : leaking) {
    all.push_back(shunted(k, static_cast<double>(leaking.size()), usual_ohm));
  }
  all.push_back(of_one_number(
      "temperature", "cells warmer or colder than stated", "change_K", 30.0, -150.0, 150.0,
      [](double x, ModuleState& state) { state.temperature_K += x; }, [](double x) { return x; }));
  all.push_back(unsteady_light());
  if (design.bypass_every > 0 && design.bypass_every < design.cells) {
    const int others = std::min(2, design.cells / design.bypass_every - 1);
    for (int k = 1; k <= others; ++k) all.push_back(substrings_shaded(design, k, others));
    ModuleHypothesis h;
    h.kind = h.label = "bypass_shorted";
    h.explanation = "a bypass diode that lets everything pass: its cells give no voltage";
    h.act = [n = design.bypass_every](X, ModuleState& state, ModuleCell&) { state.bypassed += n; };
    all.push_back(std::move(h));
  }
  all.push_back(other_diode());
  return all;
}

}  // namespace photorque
