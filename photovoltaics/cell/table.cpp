#include "photovoltaics/cell/table.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace photorque {
namespace {

double scale_of(const CellCurve& curve) {
  const CellParameters& p = curve.parameters();
  const double scale_V = std::min(p.saturation_1_A > 0 ? p.ideality_1 : p.ideality_2,
                                  p.saturation_2_A > 0 ? p.ideality_2 : p.ideality_1) *
                         curve.thermal_V();
  return std::exp2(std::floor(std::log2(curve.dark(0.0).slope_S * scale_V)));
}

// Stores {slope, curvature} cell by cell.
void store(Quad slope_ohm, Quad curvature_V_A2, JunctionState* states) {
  static_assert(sizeof(JunctionState) == 2 * sizeof(double));
  const Quad low = __builtin_shufflevector(slope_ohm, curvature_V_A2, 0, 4, 1, 5);
  const Quad high = __builtin_shufflevector(slope_ohm, curvature_V_A2, 2, 6, 3, 7);
  std::memcpy(&states[0].slope_ohm, &low, sizeof low);
  std::memcpy(&states[2].slope_ohm, &high, sizeof high);
}

}  // namespace

DiodeVoltageTable::DiodeVoltageTable(const CellCurve& curve, double largest_A)
    : DiodeVoltageLaw(curve),
      origin_A_(scale_of(curve)),
      first_bin_(std::bit_cast<uint64_t>(origin_A_) >> bin_shift),
      largest_slope_ohm_(largest_diode_slope_ohm(curve)) {
  constexpr int max_octaves = 200;
  const int octaves = std::min(
      max_octaves, 1 + static_cast<int>(std::ceil(std::log2(largest_A / origin_A_ + 1.0))));
  tabulate(1.0, octaves);
  bins_ = piece_of_bin_.size();
  tabulate(-1.0, octaves);
}

DiodeVoltageTable::Piece DiodeVoltageTable::fit(double sign, double low_s, double high_s) const {
  const DiodeVoltage a = solved_diode_voltage(curve(), sign * (low_s - origin_A_)),
                     b = solved_diode_voltage(curve(), sign * (high_s - origin_A_));
  const double h = high_s - low_s;
  const double a1 = sign * a.slope_ohm * h, b1 = sign * b.slope_ohm * h;
  const double a2 = a.curvature_V_A2 * h * h, b2 = b.curvature_V_A2 * h * h;
  const double rise = b.value_V - a.value_V;
  return {
      low_s,
      1.0 / h,
      {a.value_V, a1, 0.5 * a2, 10 * rise - 6 * a1 - 4 * b1 - 1.5 * a2 + 0.5 * b2,
       -15 * rise + 8 * a1 + 7 * b1 + 1.5 * a2 - b2, 6 * rise - 3 * (a1 + b1) - 0.5 * (a2 - b2)}};
}

bool DiodeVoltageTable::good(const Piece& p, double sign, double low_s, double high_s) const {
  const double tolerance_V = 1e-12 * curve().parameters().ideality_1 * curve().thermal_V();
  for (const double t : {0.2, 0.5, 0.8}) {
    const double v =
        p.c[0] + t * (p.c[1] + t * (p.c[2] + t * (p.c[3] + t * (p.c[4] + t * p.c[5]))));
    if (v <= curve().parameters().breakdown_V) return false;
    const DarkCurrent d = curve().dark(v);
    const double wanted_A = sign * (low_s + t * (high_s - low_s) - origin_A_);
    const double allowed_V = tolerance_V + 2e-15 * std::abs(v);
    if (std::abs(d.value_A - wanted_A) > allowed_V * d.slope_S) return false;
  }
  return true;
}

void DiodeVoltageTable::tabulate(double sign, int octaves) {
  constexpr int bins_per_octave = 1 << bins_per_octave_log2;
  for (int octave = 0; octave < octaves; ++octave) {
    const double low = std::ldexp(origin_A_, octave);
    int bin = 0, width = bins_per_octave;
    while (bin < bins_per_octave) {
      const double start = low * (1.0 + static_cast<double>(bin) / bins_per_octave);
      const double end = low * (1.0 + static_cast<double>(bin + width) / bins_per_octave);
      const Piece piece = fit(sign, start, end);
      if (width > 1 && !good(piece, sign, start, end)) {
        width /= 2;
        continue;
      }
      piece_of_bin_.insert(piece_of_bin_.end(), static_cast<size_t>(width),
                           static_cast<uint32_t>(pieces_.size()));
      pieces_.push_back(piece);
      bin += width;
      // The next piece may be as wide as its place in the octave allows.
      while (width < bins_per_octave && bin % (2 * width) == 0 && width <= bin) width *= 2;
    }
  }
}

DiodeVoltageTable::QuadVoltage DiodeVoltageTable::quad_at_dark(Quad dark_A) const {
  const QuadBits sign_bit = QuadBits{} + INT64_MIN, bins = QuadBits{} + static_cast<int64_t>(bins_);
  const QuadBits sign = bits_of(dark_A) & sign_bit;
  const Quad s = reinterpret_cast<Quad>(bits_of(dark_A) ^ sign) + origin_A_;
  const QuadBits bin = reinterpret_cast<QuadBits>(reinterpret_cast<QuadWords>(s) >> bin_shift) -
                       static_cast<int64_t>(first_bin_);
  const QuadBits outside = bin >= bins;
  const QuadBits place = (bin + ((sign == sign_bit) & bins)) & ~outside;
  // A piece is stored as eight consecutive numbers: start, 1/width and the six coefficients.
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

DiodeVoltage DiodeVoltageTable::series_at(std::span<const double> photocurrents_A,
                                          std::span<const double> copies, double current_A,
                                          std::span<JunctionState> states) const {
  Quad value_V{}, slope_ohm{}, curvature_V_A2{}, third_V_A3{};
  QuadBits any_outside{};
  for (size_t i = 0; i < photocurrents_A.size(); i += lanes) {
    const QuadVoltage v = quad_at_dark(quad_at(&photocurrents_A[i]) - current_A);
    const Quad weight = quad_at(&copies[i]);
    any_outside |= v.outside;
    value_V = multiply_add(weight, v.value_V, value_V);
    slope_ohm = multiply_add(weight, v.slope_ohm, slope_ohm);
    curvature_V_A2 = multiply_add(weight, v.curvature_V_A2, curvature_V_A2);
    third_V_A3 = multiply_add(weight, v.third_V_A3, third_V_A3);
    store(v.slope_ohm, v.curvature_V_A2, &states[i]);
  }
  if (any_of(any_outside)) {
    return series_one_by_one(*this, photocurrents_A, copies, current_A, states);
  }
  return {sum_of(value_V), sum_of(slope_ohm), sum_of(curvature_V_A2), sum_of(third_V_A3)};
}

}  // namespace photorque
