// The diode voltage of a cell as a table.
//
// Like cells under different light differ only in I_L, and V_d depends on I_L − I alone. One
// function of one variable, j ↦ V_d with D(V_d) = j (cell.h, eq. 2), therefore serves
// every cell of an array, whatever falls on it: it is tabulated once per cell type and temperature,
// and every voltage in a network is then an explicit expression.
//
// Pieces are quintic and match value, slope and curvature at their ends, in s = |j| + j₀. Their
// widths are binary fractions of an octave of s, halved until the error, measured as the residual
// of (2) over D′, is below 1e-12 n₁V_t (2.6e-14 V for one diode at room temperature). Beyond the
// table the exact solution is used.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/numerics/quad.h"
#include "photovoltaics/cell/cell.h"

namespace photorque {

struct DiodeVoltage {
  double value_V = 0.0;
  double slope_ohm = 0.0;       // dV_d/dj = 1/D′ > 0
  double curvature_V_A2 = 0.0;  // d²V_d/dj²
  double third_V_A3 = 0.0;      // d³V_d/dj³, good to 1e-3 of itself: for the speed of solutions
};

// What bounds over an interval need to know of one junction at each end.
struct JunctionState {
  double slope_ohm = 0.0;
  double curvature_V_A2 = 0.0;
};

struct QuadVoltage;  // table_quad.h

class DiodeVoltageTable {
 public:
  // Covers currents up to `largest_A` in size (> 0) in both directions.
  DiodeVoltageTable(const CellCurve& curve, double largest_A);

  const CellCurve& curve() const { return curve_; }

  DiodeVoltage at(double dark_A) const {
    const double s = std::abs(dark_A) + origin_A_;
    const uint64_t bin = (std::bit_cast<uint64_t>(s) >> bin_shift) - first_bin_;
    if (bin >= bins_) return exact(dark_A);
    const Piece& p = pieces_[piece_of_bin_[dark_A < 0 ? bin + bins_ : bin]];
    const double t = (s - p.start_A) * p.per_A;
    // Horner's scheme for the polynomial and its derivatives over their factorials.
    double value = p.c[5], first = 0.0, second = 0.0, third = 0.0;
    for (int k = 4; k >= 0; --k) {
      third = third * t + second;
      second = second * t + first;
      first = first * t + value;
      value = value * t + p.c[k];
    }
    const double per_A = std::copysign(p.per_A, dark_A), per_A2 = per_A * per_A;
    return {value, per_A * first, 2 * per_A2 * second, 6 * per_A2 * per_A * third};
  }

  // Four of at() side by side; defined in table_quad.h.
  QuadVoltage quad_at_dark(Quad dark_A) const;

  // The sum over cells in series, copies[i] times that of cell i at the dark current
  // photocurrents_A[i] − current_A; `states` gets those of the single cells. Several cells at a
  // time: all spans have one length, a multiple of `lanes`.
  static constexpr size_t lanes = 4;
  DiodeVoltage series_at(std::span<const double> photocurrents_A, std::span<const double> copies,
                         double current_A, std::span<JunctionState> states) const;

  // The largest slope of the table's function, at the inflection of D.
  double largest_slope_ohm() const { return largest_slope_ohm_; }
  size_t pieces() const { return pieces_.size(); }

 private:
  static constexpr int bins_per_octave_log2 = 8;
  static constexpr int bin_shift = 52 - bins_per_octave_log2;

  struct alignas(64) Piece {
    double start_A = 0.0;
    double per_A = 0.0;  // 1/width
    double c[6] = {};    // powers of (s − start)/width
  };
  DiodeVoltage series_one_by_one(std::span<const double> photocurrents_A,
                                 std::span<const double> copies, double current_A,
                                 std::span<JunctionState> states) const;

  DiodeVoltage exact(double dark_A) const;
  void tabulate(double sign, int octaves);
  Piece fit(double sign, double low_s, double high_s) const;
  bool good(const Piece& piece, double sign, double low_s, double high_s) const;

  CellCurve curve_;
  double origin_A_;  // j₀: a power of two near the current scale of D at zero voltage
  uint64_t first_bin_;
  double largest_slope_ohm_;
  uint64_t bins_ = 0;  // of each direction
  std::vector<Piece> pieces_;
  std::vector<uint32_t> piece_of_bin_;  // forwards, then backwards
};

}  // namespace photorque
