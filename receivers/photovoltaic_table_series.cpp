// Cells in series from one table, four at a time in vector registers.
#include <cstring>

#include "receivers/photovoltaic_table.h"

namespace photorque {
namespace {

using Quad = double __attribute__((vector_size(32)));
using QuadBits = int64_t __attribute__((vector_size(32)));
using QuadWords = uint64_t __attribute__((vector_size(32)));

Quad quad_at(const double* from) {
  Quad lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

QuadBits bits_of(Quad x) {
  return reinterpret_cast<QuadBits>(x);
}

double sum_of(Quad x) {
  return (x[0] + x[1]) + (x[2] + x[3]);
}

// Four rows of four numbers become four columns.
struct FourColumns {
  Quad a, b, c, d;
};

FourColumns transposed(Quad a, Quad b, Quad c, Quad d) {
  const Quad ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Quad ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Quad cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Quad cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return {__builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5),
          __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5),
          __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7),
          __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7)};
}

// {slope, curvature} of one cell after the other.
void store(Quad slope_ohm, Quad curvature_V_A2, JunctionState* states) {
  static_assert(sizeof(JunctionState) == 2 * sizeof(double));
  const Quad low = __builtin_shufflevector(slope_ohm, curvature_V_A2, 0, 4, 1, 5);
  const Quad high = __builtin_shufflevector(slope_ohm, curvature_V_A2, 2, 6, 3, 7);
  std::memcpy(&states[0].slope_ohm, &low, sizeof low);
  std::memcpy(&states[2].slope_ohm, &high, sizeof high);
}

}  // namespace

DiodeVoltage DiodeVoltageTable::series_one_by_one(std::span<const double> photocurrents_A,
                                                  std::span<const double> copies, double current_A,
                                                  std::span<JunctionState> states) const {
  DiodeVoltage sum;
  for (size_t i = 0; i < photocurrents_A.size(); ++i) {
    const DiodeVoltage v = at(photocurrents_A[i] - current_A);
    states[i] = {v.slope_ohm, v.curvature_V_A2};
    sum.value_V += copies[i] * v.value_V;
    sum.slope_ohm += copies[i] * v.slope_ohm;
    sum.curvature_V_A2 += copies[i] * v.curvature_V_A2;
    sum.third_V_A3 += copies[i] * v.third_V_A3;
  }
  return sum;
}

DiodeVoltage DiodeVoltageTable::series_at(std::span<const double> photocurrents_A,
                                          std::span<const double> copies, double current_A,
                                          std::span<JunctionState> states) const {
  Quad value_V{}, slope_ohm{}, curvature_V_A2{}, third_V_A3{};
  QuadBits any_outside{};
  const QuadBits sign_bit = QuadBits{} + INT64_MIN, bins = QuadBits{} + static_cast<int64_t>(bins_);
  for (size_t i = 0; i < photocurrents_A.size(); i += lanes) {
    const Quad dark_A = quad_at(&photocurrents_A[i]) - current_A;
    const QuadBits sign = bits_of(dark_A) & sign_bit;
    const Quad s = reinterpret_cast<Quad>(bits_of(dark_A) ^ sign) + origin_A_;
    const QuadBits bin = reinterpret_cast<QuadBits>(reinterpret_cast<QuadWords>(s) >> bin_shift) -
                         static_cast<int64_t>(first_bin_);
    const QuadBits outside = bin >= bins;
    any_outside |= outside;
    const QuadBits place = (bin + ((sign == sign_bit) & bins)) & ~outside;
    // A piece is eight numbers in a row: start, 1/width and the six coefficients.
    const auto half = [&](size_t lane, size_t offset) {
      const Piece& p = pieces_[piece_of_bin_[static_cast<size_t>(place[lane])]];
      return quad_at(&p.start_A + offset);
    };
    const auto [start_A, per_A, c0, c1] =
        transposed(half(0, 0), half(1, 0), half(2, 0), half(3, 0));
    const auto [c2, c3, c4, c5] = transposed(half(0, 4), half(1, 4), half(2, 4), half(3, 4));
    const Quad t = (s - start_A) * per_A;
    Quad value = c5, first{}, second{}, third{};
    const auto horner = [&](Quad coefficient) {
      third = third * t + second;
      second = second * t + first;
      first = first * t + value;
      value = value * t + coefficient;
    };
    horner(c4);
    horner(c3);
    horner(c2);
    horner(c1);
    horner(c0);
    const Quad scale = reinterpret_cast<Quad>(bits_of(per_A) ^ sign), scale2 = scale * scale;
    const Quad slope = scale * first, curvature = 2.0 * scale2 * second;
    const Quad weight = quad_at(&copies[i]);
    value_V += weight * value;
    slope_ohm += weight * slope;
    curvature_V_A2 += weight * curvature;
    third_V_A3 += weight * (6.0 * scale2 * scale * third);
    store(slope, curvature, &states[i]);
  }
  if ((any_outside[0] | any_outside[1] | any_outside[2] | any_outside[3]) != 0) {
    return series_one_by_one(photocurrents_A, copies, current_A, states);
  }
  return {sum_of(value_V), sum_of(slope_ohm), sum_of(curvature_V_A2), sum_of(third_V_A3)};
}

}  // namespace photorque
