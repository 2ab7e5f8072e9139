// The diode voltage of a cell as a function of its dark current, tabulated.
//
// The function of diode_voltage.h is tabulated once per cell type and temperature. Every voltage in
// a network then follows without a search.
//
// The interpolation is piecewise in s = |j| + j₀, with j the dark current. Each piece is a quintic
// polynomial that matches value, slope and curvature at both ends. The width of a piece is a binary
// fraction of an octave of s. It is halved until the error is below 1e-12 n₁V_t (2.6e-14 V for one
// diode at room temperature). The error is the residual of eq. 2 of cell.h divided by D′. Beyond
// the table the exact solution is used.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/numerics/quad.h"
#include "photovoltaics/cell/diode_voltage.h"

namespace photorque {

class DiodeVoltageTable final : public DiodeVoltageLaw {
 public:
  // Tabulates dark currents from −`largest_A` to `largest_A` (> 0).
  DiodeVoltageTable(const CellCurve& curve, double largest_A);

  DiodeVoltage at(double dark_A) const override {
    const double s = std::abs(dark_A) + origin_A_;
    const uint64_t bin = (std::bit_cast<uint64_t>(s) >> bin_shift) - first_bin_;
    if (bin >= bins_) return solved_diode_voltage(curve(), dark_A);
    const Piece& p = pieces_[piece_of_bin_[dark_A < 0 ? bin + bins_ : bin]];
    const double t = (s - p.start_A) * p.per_A;
    // Horner's scheme for the polynomial and its k-th derivatives divided by k!.
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

  DiodeVoltage series_at(std::span<const double> photocurrents_A, std::span<const double> copies,
                         double current_A, std::span<JunctionState> states) const override;
  double largest_slope_ohm() const override { return largest_slope_ohm_; }
  size_t pieces() const { return pieces_.size(); }

 private:
  static constexpr int bins_per_octave_log2 = 8;
  static constexpr int bin_shift = 52 - bins_per_octave_log2;

  struct alignas(64) Piece {
    double start_A = 0.0;
    double per_A = 0.0;  // 1/width
    double c[6] = {};    // coefficients of the powers of (s − start)/width
  };
  // The diode voltage and its derivatives (see DiodeVoltage) at four dark currents.
  struct QuadVoltage {
    Quad value_V, slope_ohm, curvature_V_A2, third_V_A3;
    QuadBits outside;  // non-zero in lanes beyond the table, whose numbers are invalid
  };
  QuadVoltage quad_at_dark(Quad dark_A) const;
  void tabulate(double sign, int octaves);
  Piece fit(double sign, double low_s, double high_s) const;
  bool good(const Piece& piece, double sign, double low_s, double high_s) const;

  double origin_A_;  // j₀: a power of two near the current scale of D at zero voltage
  uint64_t first_bin_;
  double largest_slope_ohm_;
  uint64_t bins_ = 0;  // number of bins for each sign of the dark current
  std::vector<Piece> pieces_;
  std::vector<uint32_t> piece_of_bin_;  // positive dark currents, then negative ones
};

}  // namespace photorque
