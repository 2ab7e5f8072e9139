#include "diagnosis/light/module/curve.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/constants.h"
#include "photovoltaics/cell/model.h"

namespace photorque {
namespace {

// The parameters of a cell in a state. They are limited, because a fit may try unphysical values:
// these result in a bad curve instead of an error.
CellParameters at_state(const ModuleCell& cell, const ModuleState& state) {
  const double T = std::clamp(state.temperature_K, 100.0, 800.0), T0 = cell.temperature_K,
               light = std::max(state.light, 1e-6);
  const Translation& by = cell.translation;
  const auto power = [&](double of_light, double of_temperature) {
    return std::exp(
        std::clamp(of_light * std::log(light) + of_temperature * std::log(T / T0), -10.0, 10.0));
  };
  const double of_ideality = power(by.ideality_by_light, by.ideality_by_temperature),
               n = std::clamp(cell.ideality * of_ideality, 0.05, 50.0);
  const double at_reference_A = std::clamp(cell.saturation_A, 1e-60, 1e3),
               open = std::log(std::clamp(cell.photocurrent_A, 1e-30, 1e9) / at_reference_A),
               saturation_A = at_reference_A * std::exp(open * (1.0 - 1.0 / of_ideality));
  const double per_kelvin = silicon_gap_eV * elementary_charge_C / boltzmann_J_K / n;
  CellParameters p;
  p.temperature_K = T;
  p.ideality_1 = n;
  p.saturation_1_A = std::clamp(
      saturation_A * std::pow(T / T0, 3.0 / n) * std::exp(per_kelvin * (1.0 / T0 - 1.0 / T)), 1e-60,
      1e3);
  p.series_ohm =
      std::clamp(cell.series_ohm * power(by.series_by_light, by.series_by_temperature), 0.0, 1e6);
  const double leak_S =
      light / (std::max(cell.shunt_ohm, 1e-9) * power(by.shunt_by_light, 0.0)) + state.shunt_S;
  p.shunt_ohm = 1.0 / std::clamp(leak_S, 1e-12, 1e6);
  return p;
}

// Parameters of a part of a cell with this fraction of its area.
CellParameters part_parameters(CellParameters p, double fraction) {
  p.saturation_1_A *= fraction;
  p.series_ohm /= fraction;
  p.shunt_ohm /= fraction;
  return p;
}

std::shared_ptr<const DiodeVoltageLaw> part_of(const CellParameters& whole, double fraction,
                                               double resistance_ohm) {
  CellParameters p = part_parameters(whole, fraction);
  p.series_ohm += resistance_ohm;
  return diode_voltage_law(p);
}

CellParameters in_reverse(CellParameters p, const ModuleState::Breakdown& b, double leak) {
  p.shunt_ohm /= leak;
  p.breakdown_fraction = b.fraction;
  p.breakdown_V = b.voltage_V;
  p.breakdown_exponent = b.exponent;
  return p;
}

// A module during construction.
struct ModuleString {
  int left = 0;  // average cells that are not assigned to a substring
  ArrayWiring wiring{{{}}};
  CellTables laws;
  std::vector<double> light_A;

  int add_cell(const std::shared_ptr<const DiodeVoltageLaw>& law, double photocurrent_A) {
    laws.push_back(law);
    light_A.push_back(photocurrent_A);
    return static_cast<int>(laws.size()) - 1;
  }
};

}  // namespace

ArrayCurve module_curve(const ModuleWiring& wiring, const ModuleCell& cell,
                        const ModuleState& state) {
  const CellParameters usual = at_state(cell, state);
  const auto usual_law = diode_voltage_law(usual);
  const double light_A = cell.photocurrent_A * state.light, share = 1.0 / wiring.chains;
  ModuleString module;
  module.left = wiring.cells - state.bypassed;
  // A group under one bypass diode: the changed cells, then average cells up to the number of cells
  // that the diode bypasses.
  struct Group {
    std::vector<CellGroup> rows;
    bool is_split, is_bypassed = true;
  };
  std::vector<Group> groups;
  const auto add = [&](int count, bool is_split, const auto& add_row) {
    count = std::min(count, module.left);
    if (count <= 0) return;
    module.left -= count;
    Group& group = groups.emplace_back(Group{{}, is_split});
    for (int i = 0; i < count; ++i) group.rows.emplace_back(add_row());
  };
  const bool has_chains = wiring.chains > 1;
  for (const auto& s : state.shaded) {
    const bool is_split = has_chains && !s.in_all_chains;
    const double part = is_split ? share : 1.0;
    const auto law = part_of(in_reverse(usual, s.breakdown, s.leak), part, 0.0);
    add(s.count, is_split,
        [&] { return std::vector{module.add_cell(law, part * light_A * s.factor)}; });
    if (!groups.empty()) groups.back().is_bypassed = s.is_bypassed;
  }
  for (const auto& s : state.shunted) {
    const auto law = diode_voltage_law(with_leak(part_parameters(usual, share), s.shunt_S));
    add(s.count, has_chains, [&] { return std::vector{module.add_cell(law, share * light_A)}; });
  }
  for (const auto& c : state.cracked) {
    // Two parts of one cell in parallel, one of them in series with a resistance.
    const CellParameters whole = in_reverse(usual, c.breakdown, c.leak);
    const double rest = share * (1.0 - c.fraction), off = share * c.fraction;
    const auto law = part_of(whole, rest, 0.0), cut = part_of(whole, off, c.resistance_ohm);
    add(c.count, has_chains, [&] {
      return std::vector{module.add_cell(law, light_A * rest), module.add_cell(cut, light_A * off)};
    });
  }
  const auto add_usual = [&](int count, std::vector<CellGroup>& rows) {
    for (int i = 0; i < count; ++i) rows.emplace_back(module.add_cell(usual_law, light_A));
  };
  Diode bypass;
  bypass.kind = Diode::Kind::clamp;
  bypass.drop_V = wiring.bypass_drop_V * state.bypass_drop;
  std::vector<ArrayWiring::Substring>& substrings = module.wiring.strings[0].substrings;
  const int under_diode = wiring.bypass_every > 0 ? wiring.bypass_every : wiring.cells;
  for (Group& group : groups) {
    ArrayWiring::Substring& substring = substrings.emplace_back();
    if (wiring.bypass_every > 0 && group.is_bypassed) substring.bypass = bypass;
    const int more = wiring.bypass_every > 0 || group.is_split
                         ? std::clamp(under_diode - static_cast<int>(group.rows.size()), 0,
                                      std::max(0, module.left))
                         : 0;
    module.left -= more;
    if (!group.is_split) {
      add_usual(more, group.rows);
      substring.rows = std::move(group.rows);
      continue;
    }
    // The other chains are equal and are modelled as one chain with their total area.
    const size_t count = group.rows.size() + static_cast<size_t>(more);
    const auto of_chain = part_of(usual, share, 0.0), of_others = part_of(usual, 1.0 - share, 0.0);
    std::vector<CellGroup> others;
    for (int i = 0; i < more; ++i) {
      group.rows.emplace_back(module.add_cell(of_chain, share * light_A));
    }
    for (size_t i = 0; i < count; ++i) {
      others.emplace_back(module.add_cell(of_others, (1.0 - share) * light_A));
    }
    using Join = CellGroup::Join;
    substring.rows.emplace_back(Join::parallel,
                                std::vector{CellGroup(Join::series, std::move(group.rows)),
                                            CellGroup(Join::series, std::move(others))});
  }
  if (module.left > 0) add_usual(module.left, substrings.emplace_back().rows);
  ArrayChanges changes;
  changes.series_ohm = state.series_ohm;
  if (substrings.empty()) {
    add_usual(1, substrings.emplace_back().rows);
    changes.bypass_shorted = {true};
  }
  return {module.wiring, std::move(module.laws), module.light_A, changes};
}

std::vector<ArrayCurve::SlopedPoint> module_points(const ModuleWiring& wiring,
                                                   const ModuleCell& cell, const ModuleState& state,
                                                   const std::vector<double>& voltage_V) {
  auto points = module_curve(wiring, cell, state).at_voltages(voltage_V);
  if (state.light_change == 0.0 && state.light_bend == 0.0) return points;
  constexpr double step = 0.01;
  ModuleState brighter = state;
  brighter.light *= 1.0 + step;
  const auto with_more = module_curve(wiring, cell, brighter).at_voltages(voltage_V);
  for (size_t i = 0; i < points.size(); ++i) {
    const double u = voltage_V[i] / voltage_V.back();
    const double more =
        state.light_change * (u - 0.5) + state.light_bend * (6.0 * u * u - 6.0 * u + 1.0);
    points[i].current_A += (with_more[i].current_A - points[i].current_A) / step * more;
  }
  return points;
}

}  // namespace photorque
