#include "photovoltaics/cell/diode_voltage.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/numerics/root.h"
#include "photovoltaics/cell/table.h"

namespace photorque {
namespace {

// Solves y + e^y = L by Newton's method. The function is convex and increasing, and the start is
// above the root.
double omega_solved(double L) {
  double y = L > 1.0 ? std::log(L) : L;
  for (int i = 0; i < 100; ++i) {
    const double grown = std::exp(y), step = (y + grown - L) / (1.0 + grown);
    y -= step;
    if (!(std::abs(step) > 1e-16 * (1.0 + std::abs(y)))) break;
  }
  return y;
}

// Table with nodes at L = s − from for s ≥ 2, evenly spaced within every octave of s. The bits of s
// give the index of a node.
class OmegaTable {
 public:
  static constexpr double from = 34.0;  // below the table e^y is negligible compared with 1
  static constexpr int nodes_log2 = 9, shift = 52 - nodes_log2, octaves = 12;

  OmegaTable() {
    End a = end_at(0);
    for (uint64_t i = 0; i < (uint64_t{octaves} << nodes_log2); ++i) {
      const End b = end_at(i + 1);
      pieces_.push_back(piece(a, b));
      a = b;
    }
  }

  double at(double L) const {
    const double s = L + from;
    if (s < 2.0) return L;
    const uint64_t i = (std::bit_cast<uint64_t>(s) >> shift) - first();
    if (i >= pieces_.size()) return beyond(L);
    const Piece& p = pieces_[i];
    const double t = (L - p.start) * p.per_L;
    return p.c[0] + t * (p.c[1] + t * (p.c[2] + t * (p.c[3] + t * (p.c[4] + t * p.c[5]))));
  }

 private:
  struct End {
    double L, y, slope, bend;  // derivatives by L
  };
  struct alignas(64) Piece {
    double start, per_L;
    double c[6];  // powers of (L − start) per_L
  };
  static uint64_t first() { return std::bit_cast<uint64_t>(2.0) >> shift; }

  static End end_at(uint64_t i) {
    const double L = std::bit_cast<double>((first() + i) << shift) - from;
    const double y = omega_solved(L), rest = 1.0 / (1.0 + std::exp(y));
    return {L, y, rest, -(1.0 - rest) * rest * rest};
  }

  static Piece piece(const End& a, const End& b) {
    const double h = b.L - a.L, a1 = h * a.slope, a2 = 0.5 * h * h * a.bend;
    // Differences of value, slope and curvature at b from the parabola of end a.
    const double p = b.y - a.y - a1 - a2, q = h * b.slope - a1 - 2.0 * a2,
                 r = 0.5 * h * h * b.bend - a2;
    return {a.L,
            1.0 / h,
            {a.y, a1, a2, 10.0 * p - 4.0 * q + r, -15.0 * p + 7.0 * q - 2.0 * r,
             6.0 * p - 3.0 * q + r}};
  }

  // Solves w + ln w = L beyond the table, with w = e^y. Each step triples the number of correct
  // digits.
  static double beyond(double L) {
    const double start = std::log(L);
    double w = L - start + start / L;
    for (int i = 0; i < 2; ++i) {
      const double off = w + std::log(w) - L, slope = 1.0 + 1.0 / w;
      w -= off / (slope + 0.5 * off / (w * w * slope));
    }
    return std::log(w);
  }

  std::vector<Piece> pieces_;
};

class SolvedDiode final : public DiodeVoltageLaw {
 public:
  explicit SolvedDiode(const CellCurve& curve) : DiodeVoltageLaw(curve) {}
  DiodeVoltage at(double dark_A) const override { return solved_diode_voltage(curve(), dark_A); }
  DiodeVoltage series_at(std::span<const double> photocurrents_A, std::span<const double> copies,
                         double current_A, std::span<JunctionState> states) const override {
    return series_one_by_one(*this, photocurrents_A, copies, current_A, states);
  }
  double largest_slope_ohm() const override { return largest_diode_slope_ohm(curve()); }
};

}  // namespace

DiodeVoltage solved_diode_voltage(const CellCurve& curve, double dark_A) {
  const double diode_V = curve.diode_voltage_V(dark_A);
  const DarkCurrent d = curve.dark(diode_V);
  const double slope = 1.0 / d.slope_S;
  const double cube = slope * slope * slope;
  return {diode_V, slope, -d.curvature_A_V2 * cube,
          (3.0 * d.curvature_A_V2 * d.curvature_A_V2 * slope - d.third_A_V3) * slope * cube};
}

// D′ has its minimum where D″ rises through zero. Without breakdown it tends to the conductance of
// the shunt.
double largest_diode_slope_ohm(const CellCurve& curve) {
  const CellParameters& p = curve.parameters();
  if (p.breakdown_fraction == 0.0) return p.shunt_ohm;
  const double low = p.breakdown_V * (1.0 - 1e-12);
  double high = 0.0;
  while (curve.dark(high).curvature_A_V2 < 0.0) high += curve.thermal_V();
  const auto bends_down = [&](double v) { return curve.dark(v).curvature_A_V2 < 0.0; };
  high = bisect(low, high, bends_down, {52}).high;
  return 1.0 / curve.dark(high).slope_S;
}

double wright_log_omega(double L) {
  static const OmegaTable table;
  return table.at(L);
}

bool OneDiode::describes(const CellParameters& p) {
  return p.saturation_1_A > 0.0 && p.saturation_2_A == 0.0 && p.breakdown_fraction == 0.0;
}

OneDiode::OneDiode(const CellCurve& curve)
    : DiodeVoltageLaw(curve),
      saturation_A_(curve.parameters().saturation_1_A),
      scale_V_(curve.parameters().ideality_1 * curve.thermal_V()),
      shunt_S_(1.0 / curve.parameters().shunt_ohm),
      log_a_(std::log(shunt_S_ * scale_V_ / saturation_A_)),
      per_A_(1.0 / (shunt_S_ * scale_V_)) {}

DiodeVoltage OneDiode::at(double dark_A) const {
  const double L = (dark_A + saturation_A_) * per_A_ - log_a_;
  const double y = wright_log_omega(L), grown = std::max(0.0, L - y);
  const double r = 1.0 / (shunt_S_ * (1.0 + grown)), r3 = r * r * r;
  const double bend = grown * shunt_S_ / scale_V_;
  return {scale_V_ * (y + log_a_), r, -bend * r3,
          bend * (2.0 * grown - 1.0) * shunt_S_ / scale_V_ * r * r * r3};
}

DiodeVoltage OneDiode::series_at(std::span<const double> photocurrents_A,
                                 std::span<const double> copies, double current_A,
                                 std::span<JunctionState> states) const {
  return series_one_by_one(*this, photocurrents_A, copies, current_A, states);
}

std::shared_ptr<const DiodeVoltageLaw> diode_voltage_law(const CellParameters& parameters,
                                                         double tabulated_A) {
  const CellCurve curve(parameters);
  if (OneDiode::describes(parameters)) return std::make_shared<const OneDiode>(curve);
  if (tabulated_A > 0.0) return std::make_shared<const DiodeVoltageTable>(curve, tabulated_A);
  return std::make_shared<const SolvedDiode>(curve);
}

std::shared_ptr<const DiodeVoltageLaw> law_in_light(std::shared_ptr<const DiodeVoltageLaw> law,
                                                    double photocurrent_A) {
  const CellParameters& p = law->curve().parameters();
  if (p.shunt_light_A == 0.0) return law;
  return diode_voltage_law(in_light(p, photocurrent_A));
}

}  // namespace photorque
