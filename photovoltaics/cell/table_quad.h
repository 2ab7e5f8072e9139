// Four junctions of one table at a time.
#pragma once

#include "core/numerics/quad.h"
#include "photovoltaics/cell/table.h"

namespace photorque {

// As DiodeVoltage, of four dark currents.
struct QuadVoltage {
  Quad value_V, slope_ohm, curvature_V_A2, third_V_A3;
  QuadBits outside;  // lanes beyond the table, whose numbers mean nothing: not zero
};

inline QuadVoltage DiodeVoltageTable::quad_at_dark(Quad dark_A) const {
  const QuadBits sign_bit = QuadBits{} + INT64_MIN, bins = QuadBits{} + static_cast<int64_t>(bins_);
  const QuadBits sign = bits_of(dark_A) & sign_bit;
  const Quad s = reinterpret_cast<Quad>(bits_of(dark_A) ^ sign) + origin_A_;
  const QuadBits bin = reinterpret_cast<QuadBits>(reinterpret_cast<QuadWords>(s) >> bin_shift) -
                       static_cast<int64_t>(first_bin_);
  const QuadBits outside = bin >= bins;
  const QuadBits place = (bin + ((sign == sign_bit) & bins)) & ~outside;
  // A piece is eight numbers in a row: start, 1/width and the six coefficients.
  const auto piece = [&](size_t lane) {
    return &pieces_[piece_of_bin_[static_cast<size_t>(place[lane])]].start_A;
  };
  const double *p0 = piece(0), *p1 = piece(1), *p2 = piece(2), *p3 = piece(3);
  const auto [start_A, per_A, c0, c1] =
      transposed(quad_at(p0), quad_at(p1), quad_at(p2), quad_at(p3));
  const auto [c2, c3, c4, c5] =
      transposed(quad_at(p0 + 4), quad_at(p1 + 4), quad_at(p2 + 4), quad_at(p3 + 4));
  const Quad t = (s - start_A) * per_A;
  Quad value = c5, first{}, second{}, third{};
  const auto horner = [&](Quad coefficient) {
    third = multiply_add(third, t, second);
    second = multiply_add(second, t, first);
    first = multiply_add(first, t, value);
    value = multiply_add(value, t, coefficient);
  };
  horner(c4);
  horner(c3);
  horner(c2);
  horner(c1);
  horner(c0);
  const Quad scale = reinterpret_cast<Quad>(bits_of(per_A) ^ sign), scale2 = scale * scale;
  return {value, scale * first, 2.0 * scale2 * second, 6.0 * scale2 * scale * third, outside};
}

}  // namespace photorque
