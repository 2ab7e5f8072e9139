#include "diagnosis/light/module/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace photorque {
namespace {

using X = std::span<const double>;

inference::Parameter wide(const std::string& name, double mean, double sigma, double low,
                          double high) {
  return {name, "", mean, mean, sigma, low, high};
}

std::vector<int> counts_up_to(int most) {
  std::vector<int> counts;
  for (const int k : {1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48}) {
    if (k <= most) counts.push_back(k);
  }
  return counts;
}

// Typical resistance of a cell: voltage over current.
double usual_ohm_of(const ModuleNominal& nominal) {
  return 0.6 / nominal.cell.photocurrent_A;
}

std::string cells(int count) {
  return count == 1 ? "one cell" : std::to_string(count) + " cells";
}

// Appends the forward drop of conducting bypass diodes relative to the stated one.
void add_bypass_drop(const ModuleDesign& design, ModuleHypothesis& h) {
  if (design.bypass_every == 0) return;
  h.parameters.push_back(wide("bypass_drop", 0.0, 0.2, -1.0, 1.0));
  for (std::vector<double>& start : h.starts) start.push_back(0.0);
  h.act = [act = std::move(h.act), at = h.parameters.size() - 1](X x, ModuleState& state,
                                                                 ModuleCell& cell) {
    act(x, state, cell);
    state.bypass_drop = std::exp(x[at]);
  };
}

// Appends reverse conduction of cells. Breakdown is soft, and its exponent may be far from the
// tabulated three in cells of other makes (J. W. Bishop, Solar Cells 25, 73 (1988)). The shunts of
// single cells differ by factors, and the shunt of a shaded cell affects the curve only in reverse.
// If diodes bypass the cells, their drop is a nuisance parameter: 0.35 V (Schottky) to 0.7 V
// (junction).
void add_reverse(const ModuleDesign& design, ModuleHypothesis& h) {
  const size_t first = h.parameters.size();
  h.parameters.push_back(wide("breakdown_fraction", std::log(0.05), 2.5, -8.0, std::log(7.0)));
  h.parameters.push_back(wide("breakdown_V", std::log(10.0), 0.8, std::log(0.5), std::log(200.0)));
  h.parameters.push_back(wide("breakdown_exponent", std::log(3.4), 0.5, 0.0, std::log(30.0)));
  h.parameters.push_back(wide("leak", 0.0, 1.0, -5.0, 5.0));
  for (std::vector<double>& start : h.starts) {
    start.insert(start.end(), {-0.3, std::log(5.0), std::log(3.4), 0.0});
  }
  h.numbers.push_back({"breakdown_fraction", [=](X x) { return std::exp(x[first]); }});
  h.numbers.push_back({"breakdown_V", [=](X x) { return -std::exp(x[first + 1]); }});
  h.numbers.push_back({"breakdown_exponent", [=](X x) { return std::exp(x[first + 2]); }});
  h.numbers.push_back({"leak", [=](X x) { return std::exp(x[first + 3]); }});
  add_bypass_drop(design, h);
}

ModuleState::Breakdown breakdown_of(X x, size_t first) {
  return {std::exp(x[first]), -std::exp(x[first + 1]), std::exp(x[first + 2])};
}

ModuleHypothesis shaded(const ModuleDesign& design, int count, double alternatives,
                        bool is_bypassed = true) {
  ModuleHypothesis h;
  h.kind = is_bypassed ? "cell_shaded" : "bypass_open";
  h.label = h.kind + " (" + cells(count) + ")";
  h.explanation = cells(count) +
                  " of the module with less light, driven into reverse conduction "
                  "by the others";
  if (!is_bypassed) h.explanation += ", because their bypass diode is open";
  h.count = count;
  h.alternatives = alternatives;
  h.limits_current = !is_bypassed || design.bypass_every == 0;
  // Photocurrents of cells differ by some per cent: many cells with a little less light are the
  // usual mismatch.
  constexpr int few_cells = 3;
  h.parameters = {wide("factor", 0.5, 0.5, 0.0, count > few_cells ? 0.9 : 1.0)};
  for (const double factor : {0.1, 0.4, 0.75}) h.starts.push_back({factor});
  h.act = [=](X x, ModuleState& state, ModuleCell&) {
    state.shaded.push_back({count, x[0], breakdown_of(x, 1), is_bypassed, false, std::exp(x[4])});
  };
  h.numbers = {{"factor", [](X x) { return x[0]; }}};
  add_reverse(design, h);
  // Adds a start with hard breakdown near the voltage of the other cells under the diode.
  const double other_cells_V = 0.6 * std::max(1, design.bypass_every);
  const size_t dark = h.starts.size();
  h.starts.push_back(h.starts[1]);
  h.starts[dark][1] = std::log(0.003);
  h.starts[dark][2] = std::log(std::clamp(1.2 * other_cells_V, 1.0, 100.0));
  if (!is_bypassed) {
    // Without a bypass diode the whole module drives them, even into hard breakdown.
    for (const double factor : {0.3, 0.7}) {
      h.starts.push_back({factor, std::log(0.02), std::log(25.0), std::log(3.4), 0.0, 0.0});
    }
  }
  return h;
}

// Each of `count` substrings has different light.
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
    // The substrings start with different factors, which give steps at different currents.
    for (size_t k = 1; k < h.starts.back().size(); ++k) h.starts.back()[k] = 0.5 + 0.5 * factor;
  }
  h.act = [count, every = design.bypass_every](X x, ModuleState& state, ModuleCell&) {
    for (int k = 0; k < count; ++k) {
      state.shaded.push_back(
          {.count = every, .factor = x[static_cast<size_t>(k)], .in_all_chains = true});
    }
  };
  add_bypass_drop(design, h);
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

// `reverse`: whether its cells also conduct in reverse, like shaded cells.
ModuleHypothesis cracked(const ModuleDesign& design, int count, double alternatives,
                         double usual_ohm, bool reverse = false) {
  ModuleHypothesis h;
  h.kind = "cell_cracked";
  h.label = "cell_cracked (" + cells(count) + ")";
  h.explanation =
      cells(count) +
      " of the module have a part that is connected only through a resistance: less active "
      "area and more series resistance; a curve does not determine which cells";
  h.count = count;
  h.alternatives = alternatives;
  h.parameters = {wide("fraction", 0.2, 0.3, 1e-3, 0.98),
                  wide("resistance_ohm", std::log(usual_ohm), 1.5, std::log(1e-4 * usual_ohm),
                       std::log(1e4 * usual_ohm))};
  h.starts = {{0.1, std::log(3.0 * usual_ohm)}, {0.4, std::log(2.0 * usual_ohm)}};
  h.act = [=](X x, ModuleState& state, ModuleCell&) {
    state.cracked.push_back({count, x[0], std::exp(x[1]),
                             reverse ? breakdown_of(x, 2) : ModuleState::Breakdown{},
                             reverse ? std::exp(x[5]) : 1.0});
  };
  h.numbers = {{"fraction", [](X x) { return x[0]; }},
               {"resistance_ohm", [](X x) { return std::exp(x[1]); }}};
  if (reverse) {
    add_reverse(design, h);
  } else {
    add_bypass_drop(design, h);
  }
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
  // A small leak shifts the curve; a large one drives the cell into reverse bias.
  for (const double relative : {0.01, 0.1, 0.5}) h.starts.push_back({relative / usual_ohm});
  h.label = "cell_shunted (" + cells(count) + ")";
  h.alternatives = alternatives;
  return h;
}

// Empirical competitor of the physical effects: some diode fits every smoothly falling curve.
ModuleHypothesis other_diode() {
  ModuleHypothesis h;
  h.label = "another diode (all five parameters)";
  h.is_empirical = true;
  for (const char* name : {"saturation", "ideality", "series", "shunt"}) {
    h.parameters.push_back(wide(name, 0.0, 1.0, -25.0, 25.0));
  }
  h.starts = {{0.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.5, -1.0}};
  h.act = [](X x, ModuleState&, ModuleCell& cell) {
    // Changes the saturation current with the ideality to keep the open-circuit voltage.
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

ModuleHypothesis cracked_hypothesis(const ModuleDesign& design, const ModuleNominal& nominal,
                                    const ModuleHypothesis& shaded, std::span<const double> own,
                                    const ModuleHypothesis& any_cracked) {
  const double usual_ohm = usual_ohm_of(nominal);
  ModuleHypothesis h =
      cracked(design, shaded.count, any_cracked.alternatives, usual_ohm, /*reverse=*/true);
  h.label += ", that conduct in reverse";
  h.largest_count = any_cracked.largest_count;
  h.effects = 1;
  constexpr double cut_off = 100.0;
  std::vector<double> start = {std::clamp(1.0 - own[0], 2e-3, 0.97), std::log(cut_off * usual_ohm)};
  start.insert(start.end(), own.begin() + 1, own.end());
  h.starts = {std::move(start)};
  return h;
}

ModuleHypothesis both(const ModuleHypothesis& a, size_t of_a, const ModuleHypothesis& b,
                      size_t of_b) {
  ModuleHypothesis h;
  h.kind = a.kind + " and " + b.kind;
  h.label = a.label + " and " + b.label;
  h.effects = a.effects + b.effects;
  h.alternatives = a.alternatives * b.alternatives;
  h.limits_current = a.limits_current;
  h.members = {{of_a, {}}, {of_b, {}}};
  constexpr const char* common[] = {"breakdown_fraction", "breakdown_V", "breakdown_exponent",
                                    "bypass_drop"};
  h.parameters = a.parameters;
  for (size_t k = 0; k < a.parameters.size(); ++k) h.members[0].at.push_back(k);
  for (const inference::Parameter& p : b.parameters) {
    const auto same = std::ranges::find(a.parameters, p.name, &inference::Parameter::name);
    const bool is_common =
        same != a.parameters.end() && std::ranges::find(common, p.name) != std::end(common);
    h.members[1].at.push_back(is_common ? static_cast<size_t>(same - a.parameters.begin())
                                        : h.parameters.size());
    if (!is_common) h.parameters.push_back(p);
  }
  h.act = [acts = std::array{a.act, b.act}, members = h.members](X x, ModuleState& state,
                                                                 ModuleCell& cell) {
    for (size_t k = 0; k < acts.size(); ++k) {
      std::vector<double> own;
      for (const size_t at : members[k].at) own.push_back(x[at]);
      acts[k](own, state, cell);
    }
  };
  return h;
}

std::vector<ModuleHypothesis> module_hypotheses(const ModuleDesign& design,
                                                const ModuleNominal& nominal) {
  std::vector<ModuleHypothesis> all(1);
  all.front().act = [](X, ModuleState&, ModuleCell&) {};
  const double usual_ohm = usual_ohm_of(nominal);
  const int under_diode = design.bypass_every > 0 ? design.bypass_every : design.cells;
  // Without diodes, many cells with a little less light resemble a mismatch or another translation.
  const std::vector<int> few = counts_up_to(std::min(3, std::max(1, under_diode - 1))),
                         dark = design.bypass_every > 0 ? counts_up_to(std::max(1, under_diode - 1))
                                                        : few;
  for (const int k : dark) all.push_back(shaded(design, k, static_cast<double>(dark.size())));
  const std::vector<int> some = counts_up_to(under_diode);
  for (const int k : some) {
    all.push_back(cracked(design, k, static_cast<double>(some.size()), usual_ohm));
  }
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
  constexpr double coldest_K = 223.0, hottest_K = 393.0;  // coldest outdoors, hottest of a hot spot
  all.push_back(of_one_number(
      "temperature", "cells warmer or colder than stated", "change_K", 30.0,
      std::min(0.0, coldest_K - design.temperature_K),
      std::max(0.0, hottest_K - design.temperature_K),
      [](double x, ModuleState& state) { state.temperature_K += x; }, [](double x) { return x; }));
  all.push_back(unsteady_light());
  if (design.bypass_every > 0) {
    // Two simultaneous faults: a shade, and a diode that does not bypass it.
    constexpr double of_diodes = 3.0;
    for (const int k : few) {
      all.push_back(shaded(design, k, of_diodes * static_cast<double>(few.size()), false));
    }
  }
  if (design.bypass_every > 0 && design.bypass_every < design.cells) {
    const int others = std::min(2, design.cells / design.bypass_every - 1);
    for (int k = 1; k <= others; ++k) all.push_back(substrings_shaded(design, k, others));
    ModuleHypothesis h;
    h.kind = h.label = "bypass_shorted";
    h.explanation = "a shorted bypass diode: its cells give no voltage";
    h.act = [n = design.bypass_every](X, ModuleState& state, ModuleCell&) { state.bypassed += n; };
    all.push_back(std::move(h));
  }
  all.push_back(other_diode());
  for (ModuleHypothesis& h : all) {
    h.effects = h.kind.empty() ? 0 : 1;
    for (const ModuleHypothesis& other : all) {
      if (other.kind == h.kind) h.largest_count = std::max(h.largest_count, other.count);
    }
  }
  return all;
}

}  // namespace photorque
