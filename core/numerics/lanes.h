// Eight numbers that are processed as one: the value of a quantity at eight instants.
//
// The propagator evaluates the torque at the eight Gauss points of a step at once. A law that is
// written once for a scalar type therefore runs on whole vector registers.
#pragma once

#include <array>
#include <cmath>

#include "core/numerics/quad.h"

namespace photorque {

struct Lanes {
  static constexpr int count = 8;
  // Two Quads instead of an array, because they stay in registers.
  Quad low;
  Quad high;

  Lanes() = default;
  // One value in every lane; implicit, so that constants mix with lanes in formulas.
  Lanes(double x) : low{x, x, x, x}, high{x, x, x, x} {}  // NOLINT(google-explicit-constructor)
  Lanes(Quad a, Quad b) : low(a), high(b) {}
  explicit Lanes(const std::array<double, count>& x)
      : low{x[0], x[1], x[2], x[3]}, high{x[4], x[5], x[6], x[7]} {}

  double operator[](int lane) const { return lane < 4 ? low[lane] : high[lane - 4]; }
  void set(int lane, double x) {
    if (lane < 4) {
      low[lane] = x;
    } else {
      high[lane - 4] = x;
    }
  }

  Lanes operator-() const { return {-low, -high}; }
  Lanes& operator+=(const Lanes& b) {
    low += b.low;
    high += b.high;
    return *this;
  }
  Lanes& operator-=(const Lanes& b) {
    low -= b.low;
    high -= b.high;
    return *this;
  }
  Lanes& operator*=(const Lanes& b) {
    low *= b.low;
    high *= b.high;
    return *this;
  }
  Lanes& operator/=(const Lanes& b) {
    low /= b.low;
    high /= b.high;
    return *this;
  }

  friend Lanes operator+(const Lanes& a, const Lanes& b) {
    return {a.low + b.low, a.high + b.high};
  }
  friend Lanes operator-(const Lanes& a, const Lanes& b) {
    return {a.low - b.low, a.high - b.high};
  }
  friend Lanes operator*(const Lanes& a, const Lanes& b) {
    return {a.low * b.low, a.high * b.high};
  }
  friend Lanes operator/(const Lanes& a, const Lanes& b) {
    return {a.low / b.low, a.high / b.high};
  }
  // Whether all lanes are equal; Eigen requires this operator.
  friend bool operator==(const Lanes& a, const Lanes& b) {
    for (int i = 0; i < count; ++i) {
      if (a[i] != b[i]) return false;
    }
    return true;
  }
};

// Applies `f` to every lane.
template <class Function>
Lanes each_lane(const Lanes& x, const Function& f) {
  return {Quad{f(x.low[0]), f(x.low[1]), f(x.low[2]), f(x.low[3])},
          Quad{f(x.high[0]), f(x.high[1]), f(x.high[2]), f(x.high[3])}};
}

inline Lanes sqrt(const Lanes& x) {
  return {sqrt(x.low), sqrt(x.high)};
}
// Accurate to two units in the last place for |x| < 2.5e7, to the library's accuracy beyond.
Lanes sin(const Lanes& x);
Lanes cos(const Lanes& x);
// Accurate to one unit in the last place.
inline Lanes exp(const Lanes& x) {
  return {exp(x.low), exp(x.high)};
}
inline Lanes log(const Lanes& x) {
  return {log(x.low), log(x.high)};
}
Lanes pow(const Lanes& x, double exponent);
// Accurate to three units in the last place for finite numbers; 0 for two zeros of any sign.
Lanes atan2(const Lanes& y, const Lanes& x);

// a where x ≥ bound, b elsewhere; lane by lane.
inline Lanes where_at_least(const Lanes& x, double bound, const Lanes& a, const Lanes& b) {
  return {x.low >= bound ? a.low : b.low, x.high >= bound ? a.high : b.high};
}

inline Lanes max(const Lanes& a, const Lanes& b) {
  return {max(a.low, b.low), max(a.high, b.high)};
}

// The larger of |a| and |b|, lane by lane; |a| if b is NaN.
inline Lanes larger_magnitude(const Lanes& a, const Lanes& b) {
  return {max(abs(a.low), abs(b.low)), max(abs(a.high), abs(b.high))};
}

inline double sum(const Lanes& x) {
  const Quad s = x.low + x.high;
  return (s[0] + s[3]) + (s[1] + s[2]);
}

// The largest of the lanes, none of which may be NaN.
inline double largest(const Lanes& x) {
  const Quad m = max(x.low, x.high);
  const double a = m[0] > m[1] ? m[0] : m[1];
  const double b = m[2] > m[3] ? m[2] : m[3];
  return a > b ? a : b;
}

}  // namespace photorque
