// The diode voltage of a cell as a table.
//
// Like cells under different light differ only in I_L, and V_d depends on I_L − I alone. One
// function of one variable, j ↦ V_d with D(V_d) = j (photovoltaic_cell.h, eq. 2), therefore serves
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
#include <cstdint>
#include <vector>

#include "receivers/photovoltaic_cell.h"

namespace photorque {

struct DiodeVoltage {
  double value_V = 0.0;
  double slope_ohm = 0.0;       // dV_d/dj = 1/D′ > 0
  double curvature_V_A2 = 0.0;  // d²V_d/dj²
};

class DiodeVoltageTable {
 public:
  // Covers currents up to `largest_A` in size (> 0) in both directions.
  DiodeVoltageTable(const CellCurve& curve, double largest_A);

  const CellCurve& curve() const { return curve_; }

  DiodeVoltage at(double dark_A) const {
    const double s = std::abs(dark_A) + origin_A_;
    const uint64_t bin = (std::bit_cast<uint64_t>(s) >> bin_shift) - first_bin_;
    const Side& side = dark_A < 0 ? reverse_ : forward_;
    if (bin >= side.piece_of_bin.size()) return exact(dark_A);
    const Piece& p = side.pieces[side.piece_of_bin[bin]];
    const double t = (s - p.start_A) * p.per_A;
    // Horner's scheme for the polynomial, its derivative and half its second derivative.
    double value = p.c[5], first = 0.0, half_second = 0.0;
    for (int k = 4; k >= 0; --k) {
      half_second = half_second * t + first;
      first = first * t + value;
      value = value * t + p.c[k];
    }
    return {value, std::copysign(p.per_A, dark_A) * first, 2 * p.per_A * p.per_A * half_second};
  }

  // The largest slope of the table's function, at the inflection of D.
  double largest_slope_ohm() const { return largest_slope_ohm_; }
  size_t pieces() const { return forward_.pieces.size() + reverse_.pieces.size(); }

 private:
  static constexpr int bins_per_octave_log2 = 8;
  static constexpr int bin_shift = 52 - bins_per_octave_log2;

  struct alignas(64) Piece {
    double start_A = 0.0;
    double per_A = 0.0;  // 1/width
    double c[6] = {};    // powers of (s − start)/width
  };
  struct Side {
    std::vector<Piece> pieces;
    std::vector<uint16_t> piece_of_bin;
  };

  DiodeVoltage exact(double dark_A) const;
  Side tabulate(double sign, double largest_A) const;
  Piece fit(double sign, double low_s, double high_s) const;
  bool good(const Piece& piece, double sign, double low_s, double high_s) const;

  CellCurve curve_;
  double origin_A_;  // j₀: a power of two near the current scale of D at zero voltage
  uint64_t first_bin_;
  double largest_slope_ohm_;
  Side forward_, reverse_;
};

}  // namespace photorque
