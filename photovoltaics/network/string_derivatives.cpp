// Bounds of a StringCurve between two points, its derivatives, and the states of its cells.
#include <algorithm>
#include <cmath>

#include "photovoltaics/network/string.h"

namespace photorque {

SlopeRange StringCurve::part_range(uint32_t index, const StringState& low_i,
                                   const StringState& high_i, const StringRegime& regime) const {
  if (regime.clamped[index] != 0) return {};
  const Part& part = parts_[index];
  SlopeRange sum;
  if (part.in_parallel) {
    if (clamping_part(index, regime) != nothing) return {};
    for (uint32_t c = part.first_cell; c < part.first_cell + part.cells; ++c) {
      sum += inverted(cell_range(cells_[c], low_i.cells[c], high_i.cells[c]));
    }
    for (const uint32_t p : inner(part)) sum += inverted(part_range(p, low_i, high_i, regime));
    sum = inverted(sum);
  } else {
    for (const Run& run : runs_of(part)) {
      for (uint32_t c = run.first_cell; c < run.first_cell + run.cells; ++c) {
        sum += cell_range(cells_[c], low_i.cells[c], high_i.cells[c]) * cells_[c].copies;
      }
    }
    for (const uint32_t p : inner(part)) sum += part_range(p, low_i, high_i, regime);
  }
  if (part.bypass.kind != Diode::Kind::junction || sum.slope_high == 0.0) return sum;
  SlopeRange both = inverted(sum);
  both += part.bypass.range(low_i.parts[index].junction_S, high_i.parts[index].junction_S);
  return inverted(both);
}

SlopeRange StringCurve::resistance_range(const StringState& low_i, const StringState& high_i,
                                         const StringRegime& regime) const {
  SlopeRange sum;
  for (uint32_t k = 0; k < substrings_; ++k) sum += part_range(k, low_i, high_i, regime);
  if (blocking_.kind == Diode::Kind::junction) {
    const double low = high_i.blocking_ohm, high = low_i.blocking_ohm;
    sum += SlopeRange{low + blocking_.series_ohm, high + blocking_.series_ohm,
                      low * low * blocking_.per_scale_1_V, high * high * blocking_.per_scale_1_V};
  }
  return sum;
}

SlopeRange StringCurve::conductance_range(const StringState& low_i, const StringState& high_i,
                                          const StringRegime& regime) const {
  return regime.blocked ? SlopeRange{} : inverted(resistance_range(low_i, high_i, regime));
}

// At a fixed current of a part each photocurrent p changes its voltage by m = ∂V/∂p, and the slope
// by m′ = ∂²V/∂I∂p. For a cell m = r = dV_d/dj and m′ = −q, with q = dr/dj; in series they are
// unchanged. In parallel the current of a branch with ρ = −dV/dI and κ = d²V/dI² changes at a fixed
// voltage by g = m/ρ, and its slope dI/dV by h = −(κ g + m′)/ρ². With S = Σ 1/ρ and K = Σ κ/ρ³ over
// all branches
//   ∂V/∂p = g/S,   ∂²V/∂I∂p = −(K g/S + h)/S².
// For cells in parallel with a junction of the conductance G = di/dw, and with D = 1 + ρ G,
//   ∂V/∂p = m/D,   ∂²V/∂I∂p = m′/D² − m (ρ² dG/dw − G κ)/D³.
StringCurve::PartMotion StringCurve::motion_of(uint32_t index, const StringState& state,
                                               const StringRegime& regime) const {
  PartMotion motion;
  if (regime.clamped[index] != 0) return motion;
  const Part& part = parts_[index];
  if (part.in_parallel) {
    if (clamping_part(index, regime) != nothing) return motion;
    Slopes all;  // sums of I(V)
    const auto add = [&](const Slopes& branch, std::vector<VoltageMotion> moved) {
      all += inverted(branch);
      for (VoltageMotion& m : moved) {
        const double g = m.voltage_ohm / branch.slope;
        m.slope_V_A2 = -(branch.curvature * g + m.slope_V_A2) / (branch.slope * branch.slope);
        m.voltage_ohm = g;
        motion.moved.push_back(m);
      }
    };
    for (uint32_t c = part.first_cell; c < part.first_cell + part.cells; ++c) {
      const JunctionState& cell = state.cells[c];
      add({cell.slope_ohm + cells_[c].series_ohm, cell.curvature_V_A2, 0.0},
          {{c, cell.slope_ohm, -cell.curvature_V_A2}});
    }
    for (const uint32_t p : inner(part)) {
      PartMotion branch = motion_of(p, state, regime);
      add({branch.slope_ohm, branch.curvature_V_A2, 0.0}, std::move(branch.moved));
    }
    const double S = all.slope, K = all.curvature;
    for (VoltageMotion& m : motion.moved) {
      m.slope_V_A2 = -(K * m.voltage_ohm / S + m.slope_V_A2) / (S * S);
      m.voltage_ohm /= S;
    }
    motion.slope_ohm = 1.0 / S;
    motion.curvature_V_A2 = K / (S * S * S);
  } else {
    for (const Run& run : runs_of(part)) {
      for (uint32_t c = run.first_cell; c < run.first_cell + run.cells; ++c) {
        const JunctionState& cell = state.cells[c];
        motion.moved.push_back({c, cell.slope_ohm, -cell.curvature_V_A2});
        motion.slope_ohm += copies_[c] * (cell.slope_ohm + cells_[c].series_ohm);
        motion.curvature_V_A2 += copies_[c] * cell.curvature_V_A2;
      }
    }
    for (const uint32_t p : inner(part)) {
      const PartMotion member = motion_of(p, state, regime);
      motion.moved.insert(motion.moved.end(), member.moved.begin(), member.moved.end());
      motion.slope_ohm += member.slope_ohm;
      motion.curvature_V_A2 += member.curvature_V_A2;
    }
  }
  if (part.bypass.kind != Diode::Kind::junction) return motion;
  const Slopes diode = part.bypass.slopes(state.parts[index].junction_S);
  const double ohm = motion.slope_ohm, D = 1.0 + ohm * diode.slope;
  const double more = ohm * ohm * diode.curvature - diode.slope * motion.curvature_V_A2;
  for (VoltageMotion& m : motion.moved) {
    m.slope_V_A2 = (m.slope_V_A2 - m.voltage_ohm * more / D) / (D * D);
    m.voltage_ohm /= D;
  }
  motion.slope_ohm = ohm / D;
  motion.curvature_V_A2 = (motion.curvature_V_A2 + ohm * ohm * ohm * diode.curvature) / (D * D * D);
  return motion;
}

std::vector<VoltageMotion> StringCurve::voltage_motions(const StringState& state,
                                                        const StringRegime& regime) const {
  std::vector<VoltageMotion> all;  // per cell of the wiring
  for (uint32_t k = 0; k < substrings_; ++k) {
    for (const VoltageMotion& m : motion_of(k, state, regime).moved) {
      for (const int wired : wired_to(static_cast<uint32_t>(m.cell))) {
        all.push_back({static_cast<size_t>(wired), m.voltage_ohm, m.slope_V_A2});
      }
    }
  }
  return all;
}

void StringCurve::part_cells_at(uint32_t index, double current_A, StringState& state,
                                std::vector<double>& voltages_V,
                                std::vector<double>& currents_A) const {
  const Part& part = parts_[index];
  double inside_A = current_A;
  if (part.bypass.kind == Diode::Kind::clamp) inside_A = std::min(inside_A, part.own_clamp_A);
  if (part.bypass.kind == Diode::Kind::junction) {
    bypassed_at(index, current_A, nullptr, 1e-9, state);
    inside_A -=
        part.bypass.saturation_A * std::expm1(state.parts[index].junction_V / part.bypass.scale_V);
  }
  if (!part.in_parallel) {
    for (const Run& run : runs_of(part)) {
      for (uint32_t c = run.first_cell; c < run.first_cell + run.cells; ++c) {
        const double voltage_V = cell_at(cells_[c], inside_A, state.cells[c]).voltage_V;
        for (const int wired : wired_to(c)) {
          voltages_V[static_cast<size_t>(wired)] = voltage_V;
          currents_A[static_cast<size_t>(wired)] = inside_A;
        }
      }
    }
    for (const uint32_t p : inner(part)) {
      part_cells_at(p, inside_A, state, voltages_V, currents_A);
    }
    return;
  }
  const double voltage_V = inside_at(index, inside_A, nullptr, 1e-9, state).voltage_V;
  double left_A = inside_A;
  for (uint32_t c = part.first_cell; c < part.first_cell + part.cells; ++c) {
    const auto wired = static_cast<size_t>(wired_to(c).front());
    voltages_V[wired] = voltage_V;
    currents_A[wired] =
        cells_[c].law->curve().current_A(cells_[c].photocurrent_A, voltage_V - cells_[c].offset_V);
    left_A -= currents_A[wired];
  }
  uint32_t holding = nothing;
  for (const uint32_t p : inner(part)) {
    constexpr double same_V = 1e-9;
    if (holding == nothing && voltage_V <= parts_[p].lowest_V + same_V) {
      holding = p;
      continue;
    }
    const double part_current_A = part_A(p, voltage_V, nullptr, state);
    left_A -= part_current_A;
    part_cells_at(p, part_current_A, state, voltages_V, currents_A);
  }
  if (holding != nothing) part_cells_at(holding, left_A, state, voltages_V, currents_A);
}

void StringCurve::cells_at(double current_A, std::vector<double>& voltages_V,
                           std::vector<double>& currents_A) const {
  StringState state = make_state();
  for (uint32_t k = 0; k < substrings_; ++k) {
    part_cells_at(k, current_A, state, voltages_V, currents_A);
  }
}

}  // namespace photorque
