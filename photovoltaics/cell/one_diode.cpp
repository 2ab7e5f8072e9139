#include "photovoltaics/cell/one_diode.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace photorque {
namespace {

// Newton's steps on a convex function that rises, from above its root.
double omega_solved(double L) {
  double y = L > 1.0 ? std::log(L) : L;
  for (int i = 0; i < 100; ++i) {
    const double grown = std::exp(y), step = (y + grown - L) / (1.0 + grown);
    y -= step;
    if (!(std::abs(step) > 1e-16 * (1.0 + std::abs(y)))) break;
  }
  return y;
}

// Nodes at L = s − from, s from 2 on, evenly within every octave of s: the binary form of s counts
// them.
class OmegaTable {
 public:
  static constexpr double from = 34.0;  // e^y is nothing beside 1 below
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
    // What the parabola of one end leaves at the other.
    const double p = b.y - a.y - a1 - a2, q = h * b.slope - a1 - 2.0 * a2,
                 r = 0.5 * h * h * b.bend - a2;
    return {a.L,
            1.0 / h,
            {a.y, a1, a2, 10.0 * p - 4.0 * q + r, -15.0 * p + 7.0 * q - 2.0 * r,
             6.0 * p - 3.0 * q + r}};
  }

  // w + ln w = L, w = e^y: each step multiplies the digits by three.
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

}  // namespace

double wright_log_omega(double L) {
  static const OmegaTable table;
  return table.at(L);
}

OneDiode::OneDiode(const CellParameters& parameters, double thermal_V)
    : saturation_A_(parameters.saturation_1_A),
      scale_V_(parameters.ideality_1 * thermal_V),
      shunt_S_(1.0 / parameters.shunt_ohm),
      log_a_(std::log(shunt_S_ * scale_V_ / saturation_A_)),
      per_A_(1.0 / (shunt_S_ * scale_V_)) {}

OneDiode::Point OneDiode::at(double dark_A) const {
  const double L = (dark_A + saturation_A_) * per_A_ - log_a_;
  const double y = wright_log_omega(L), grown = std::max(0.0, L - y);
  const double r = 1.0 / (shunt_S_ * (1.0 + grown));
  return {scale_V_ * (y + log_a_), r, -shunt_S_ * grown / scale_V_ * r * r * r};
}

}  // namespace photorque
