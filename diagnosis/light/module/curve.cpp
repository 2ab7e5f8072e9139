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

// Builds the circuit of a module. Substrings are listed in this order: groups with changed cells,
// then the other cells.
class ModuleBuilder {
 public:
  ModuleBuilder(const ModuleWiring& wiring, const ModuleCell& cell, const ModuleState& state)
      : wiring_(wiring),
        state_(state),
        average_(at_state(cell, state)),
        average_law_(diode_voltage_law(average_)),
        light_A_(cell.photocurrent_A * state.light),
        left_(wiring.cells - state.bypassed) {}

  ArrayCurve curve() {
    add_changed_cells();
    for (Group& group : groups_) add_substring(group);
    if (left_ > 0) add_average(left_, substrings().emplace_back().rows);
    ArrayChanges changes;
    changes.series_ohm = state_.series_ohm;
    if (substrings().empty()) {
      add_average(1, substrings().emplace_back().rows);
      changes.bypass_shorted = {true};
    }
    return {array_, std::move(laws_), photocurrent_A_, changes};
  }

 private:
  // A group under one bypass diode: the changed cells, then average cells up to the number of cells
  // that the diode bypasses.
  struct Group {
    std::vector<CellGroup> rows;
    bool is_split;  // in one of several chains in parallel
    bool is_bypassed;
  };

  std::vector<ArrayWiring::Substring>& substrings() { return array_.strings[0].substrings; }

  int add_cell(const std::shared_ptr<const DiodeVoltageLaw>& law, double photocurrent_A) {
    laws_.push_back(law);
    photocurrent_A_.push_back(photocurrent_A);
    return static_cast<int>(laws_.size()) - 1;
  }

  void add_average(int count, std::vector<CellGroup>& rows) {
    for (int i = 0; i < count; ++i) rows.emplace_back(add_cell(average_law_, light_A_));
  }

  // Adds a group of at most `count` rows, as many as there are cells left.
  template <class AddRow>
  void add_group(int count, bool is_split, bool is_bypassed, const AddRow& add_row) {
    count = std::min(count, left_);
    if (count <= 0) return;
    left_ -= count;
    Group& group = groups_.emplace_back(Group{{}, is_split, is_bypassed});
    for (int i = 0; i < count; ++i) group.rows.emplace_back(add_row());
  }

  void add_changed_cells() {
    const bool has_chains = wiring_.chains > 1;
    for (const auto& s : state_.shaded) {
      const bool is_split = has_chains && !s.in_all_chains;
      const double part = is_split ? of_chain_ : 1.0;
      const auto law = part_of(in_reverse(average_, s.breakdown, s.leak), part, 0.0);
      add_group(s.count, is_split, s.is_bypassed,
                [&] { return std::vector{add_cell(law, part * light_A_ * s.factor)}; });
    }
    for (const auto& s : state_.shunted) {
      const auto law =
          diode_voltage_law(with_leak(part_parameters(average_, of_chain_), s.shunt_S));
      add_group(s.count, has_chains, true,
                [&] { return std::vector{add_cell(law, of_chain_ * light_A_)}; });
    }
    for (const auto& c : state_.cracked) {
      // Two parts of one cell in parallel, one of them in series with a resistance.
      const CellParameters whole = in_reverse(average_, c.breakdown, c.leak);
      const double rest = of_chain_ * (1.0 - c.fraction), off = of_chain_ * c.fraction;
      const auto law = part_of(whole, rest, 0.0), cut = part_of(whole, off, c.resistance_ohm);
      add_group(c.count, has_chains, true, [&] {
        return std::vector{add_cell(law, light_A_ * rest), add_cell(cut, light_A_ * off)};
      });
    }
  }

  void add_substring(Group& group) {
    ArrayWiring::Substring& substring = substrings().emplace_back();
    const bool has_diodes = wiring_.bypass_every > 0;
    if (has_diodes && group.is_bypassed) {
      substring.bypass.kind = Diode::Kind::clamp;
      substring.bypass.drop_V = wiring_.bypass_drop_V * state_.bypass_drop;
    }
    const int under_diode = has_diodes ? wiring_.bypass_every : wiring_.cells;
    const int more =
        has_diodes || group.is_split
            ? std::clamp(under_diode - static_cast<int>(group.rows.size()), 0, std::max(0, left_))
            : 0;
    left_ -= more;
    if (!group.is_split) {
      add_average(more, group.rows);
      substring.rows = std::move(group.rows);
      return;
    }
    // The other chains are equal and are modelled as one chain with their total area.
    const size_t count = group.rows.size() + static_cast<size_t>(more);
    const double of_others = 1.0 - of_chain_;
    const auto law = part_of(average_, of_chain_, 0.0),
               law_of_others = part_of(average_, of_others, 0.0);
    std::vector<CellGroup> others;
    for (int i = 0; i < more; ++i) group.rows.emplace_back(add_cell(law, of_chain_ * light_A_));
    for (size_t i = 0; i < count; ++i) {
      others.emplace_back(add_cell(law_of_others, of_others * light_A_));
    }
    using Join = CellGroup::Join;
    substring.rows.emplace_back(Join::parallel,
                                std::vector{CellGroup(Join::series, std::move(group.rows)),
                                            CellGroup(Join::series, std::move(others))});
  }

  const ModuleWiring& wiring_;
  const ModuleState& state_;
  CellParameters average_;
  std::shared_ptr<const DiodeVoltageLaw> average_law_;
  double light_A_;  // photocurrent of an average cell
  double of_chain_ = 1.0 / wiring_.chains;
  int left_;  // cells that are not assigned to a substring
  std::vector<Group> groups_;
  ArrayWiring array_{{{}}};
  CellTables laws_;
  std::vector<double> photocurrent_A_;
};

}  // namespace

ArrayCurve module_curve(const ModuleWiring& wiring, const ModuleCell& cell,
                        const ModuleState& state) {
  return ModuleBuilder(wiring, cell, state).curve();
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
