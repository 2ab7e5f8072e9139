#include "photovoltaics/cell/table.h"

#include <algorithm>

#include "core/numerics/root.h"

namespace photorque {
namespace {

DiodeVoltage inverse(const DarkCurrent& d, double diode_V) {
  const double slope = 1.0 / d.slope_S;
  const double cube = slope * slope * slope;
  return {diode_V, slope, -d.curvature_A_V2 * cube,
          (3.0 * d.curvature_A_V2 * d.curvature_A_V2 * slope - d.third_A_V3) * slope * cube};
}

// D″ rises through zero once and D′ is least there; without breakdown D′ falls to the shunt's.
double largest_slope(const CellCurve& curve) {
  const CellParameters& p = curve.parameters();
  if (p.breakdown_fraction == 0.0) return p.shunt_ohm;
  const double low = p.breakdown_V * (1.0 - 1e-12);
  double high = 0.0;
  while (curve.dark(high).curvature_A_V2 < 0.0) high += curve.thermal_V();
  const auto bends_down = [&](double v) { return curve.dark(v).curvature_A_V2 < 0.0; };
  high = bisect(low, high, bends_down, {52}).high;
  return 1.0 / curve.dark(high).slope_S;
}

double scale_of(const CellCurve& curve) {
  const CellParameters& p = curve.parameters();
  const double scale_V = std::min(p.saturation_1_A > 0 ? p.ideality_1 : p.ideality_2,
                                  p.saturation_2_A > 0 ? p.ideality_2 : p.ideality_1) *
                         curve.thermal_V();
  return std::exp2(std::floor(std::log2(curve.dark(0.0).slope_S * scale_V)));
}

}  // namespace

DiodeVoltageTable::DiodeVoltageTable(const CellCurve& curve, double largest_A)
    : curve_(curve),
      origin_A_(scale_of(curve)),
      first_bin_(std::bit_cast<uint64_t>(origin_A_) >> bin_shift),
      largest_slope_ohm_(largest_slope(curve)) {
  constexpr int max_octaves = 200;
  const int octaves = std::min(
      max_octaves, 1 + static_cast<int>(std::ceil(std::log2(largest_A / origin_A_ + 1.0))));
  tabulate(1.0, octaves);
  bins_ = piece_of_bin_.size();
  tabulate(-1.0, octaves);
}

DiodeVoltage DiodeVoltageTable::exact(double dark_A) const {
  const double diode_V = curve_.diode_voltage_V(dark_A);
  return inverse(curve_.dark(diode_V), diode_V);
}

DiodeVoltageTable::Piece DiodeVoltageTable::fit(double sign, double low_s, double high_s) const {
  const DiodeVoltage a = exact(sign * (low_s - origin_A_)), b = exact(sign * (high_s - origin_A_));
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
  const double tolerance_V = 1e-12 * curve_.parameters().ideality_1 * curve_.thermal_V();
  for (const double t : {0.2, 0.5, 0.8}) {
    const double v =
        p.c[0] + t * (p.c[1] + t * (p.c[2] + t * (p.c[3] + t * (p.c[4] + t * p.c[5]))));
    if (v <= curve_.parameters().breakdown_V) return false;
    const DarkCurrent d = curve_.dark(v);
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

}  // namespace photorque
