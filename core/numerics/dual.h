// Numbers with exact first derivatives with respect to a block of eight variables (forward
// automatic differentiation), and the few functions that torque laws need beyond arithmetic. Every
// function exists for Lanes and for DualLanes with the same meaning.
#pragma once

#include <Eigen/Core>

#include "core/numerics/lanes.h"

namespace photorque {

// Value and derivatives at eight instants. Partial k is the derivative with respect to the k-th
// variable of the block, which the caller selects by seed(). Most numbers of a torque law depend on
// none of these variables. Such constants have no partials, and operations on them compute none.
class DualLanes {
 public:
  static constexpr int block = 8;
  using Partials = std::array<Lanes, block>;
  Lanes value;

  DualLanes() = default;
  // A constant; implicit, so that constants mix with duals in formulas.
  DualLanes(double x) : value(x) {}        // NOLINT(google-explicit-constructor)
  DualLanes(const Lanes& x) : value(x) {}  // NOLINT(google-explicit-constructor)
  DualLanes(const DualLanes& b) : value(b.value), varies_(b.varies_) {
    if (varies_) partials_ = b.partials_;
  }
  DualLanes& operator=(const DualLanes& b) {
    value = b.value;
    varies_ = b.varies_;
    if (varies_) partials_ = b.partials_;
    return *this;
  }
  ~DualLanes() = default;

  Partials partials() const {
    if (varies_) return partials_;
    Partials zero;
    zero.fill(Lanes(0.0));
    return zero;
  }
  // Makes this the k-th variable of the block.
  void seed(int k) {
    partials_ = partials();
    partials_[static_cast<size_t>(k)] = 1.0;
    varies_ = true;
  }

  // f(x) given f and df/dx at x.
  static DualLanes chain(const DualLanes& x, const Lanes& f, const Lanes& slope) {
    DualLanes r(f);
    if (x.varies_) r.fill([&](size_t k) { return slope * x.partials_[k]; });
    return r;
  }
  // f(x, y) given f, ∂f/∂x and ∂f/∂y.
  static DualLanes chain(const DualLanes& x, const DualLanes& y, const Lanes& f,
                         const Lanes& slope_x, const Lanes& slope_y) {
    if (!y.varies_) return chain(x, f, slope_x);
    if (!x.varies_) return chain(y, f, slope_y);
    DualLanes r(f);
    r.fill([&](size_t k) { return slope_x * x.partials_[k] + slope_y * y.partials_[k]; });
    return r;
  }

  DualLanes operator-() const { return chain(*this, -value, -1.0); }
  DualLanes& operator+=(const DualLanes& b) {
    value += b.value;
    if (!b.varies_) return *this;
    if (varies_) {
      fill([&](size_t k) { return partials_[k] + b.partials_[k]; });
    } else {
      fill([&](size_t k) { return b.partials_[k]; });
    }
    return *this;
  }
  DualLanes& operator-=(const DualLanes& b) {
    value -= b.value;
    if (!b.varies_) return *this;
    if (varies_) {
      fill([&](size_t k) { return partials_[k] - b.partials_[k]; });
    } else {
      fill([&](size_t k) { return -b.partials_[k]; });
    }
    return *this;
  }
  DualLanes& operator*=(const DualLanes& b) { return *this = *this * b; }
  DualLanes& operator/=(const DualLanes& b) { return *this = *this / b; }

  friend DualLanes operator+(DualLanes a, const DualLanes& b) { return a += b; }
  friend DualLanes operator-(DualLanes a, const DualLanes& b) { return a -= b; }
  friend DualLanes operator*(const DualLanes& a, const DualLanes& b) {
    return chain(a, b, a.value * b.value, b.value, a.value);
  }
  friend DualLanes operator/(const DualLanes& a, const DualLanes& b) {
    const Lanes inverse = 1.0 / b.value;
    const Lanes quotient = a.value * inverse;
    return chain(a, b, quotient, inverse, -quotient * inverse);
  }
  // Constant factors have no derivatives.
  friend DualLanes operator*(double a, const DualLanes& b) { return chain(b, a * b.value, a); }
  friend DualLanes operator*(const DualLanes& a, double b) { return chain(a, a.value * b, b); }
  friend DualLanes operator/(const DualLanes& a, double b) { return a * (1.0 / b); }
  friend bool operator==(const DualLanes& a, const DualLanes& b) { return a.value == b.value; }
  // a if x ≥ bound, otherwise b, with derivatives, for each lane.
  friend DualLanes where_at_least(const DualLanes& x, double bound, const DualLanes& a,
                                  const DualLanes& b) {
    DualLanes r(where_at_least(x.value, bound, a.value, b.value));
    if (!a.varies_ && !b.varies_) return r;
    const Partials of_a = a.partials(), of_b = b.partials();
    r.fill([&](size_t k) { return where_at_least(x.value, bound, of_a[k], of_b[k]); });
    return r;
  }

 private:
  template <class Function>
  void fill(const Function& partial) {
    for (size_t k = 0; k < partials_.size(); ++k) partials_[k] = partial(k);
    varies_ = true;
  }

  bool varies_ = false;
  Partials partials_;  // valid if `varies_`
};

// chain() for plain values without derivatives, so that one formula is valid for both types.
inline Lanes chain(const Lanes& /*x*/, const Lanes& f, const Lanes& /*slope*/) {
  return f;
}
inline Lanes chain(const Lanes& /*x*/, const Lanes& /*y*/, const Lanes& f, const Lanes& /*slope_x*/,
                   const Lanes& /*slope_y*/) {
  return f;
}
inline DualLanes chain(const DualLanes& x, const Lanes& f, const Lanes& slope) {
  return DualLanes::chain(x, f, slope);
}
inline DualLanes chain(const DualLanes& x, const DualLanes& y, const Lanes& f, const Lanes& slope_x,
                       const Lanes& slope_y) {
  return DualLanes::chain(x, y, f, slope_x, slope_y);
}

inline DualLanes sqrt(const DualLanes& x) {
  const Lanes root = sqrt(x.value);
  return DualLanes::chain(x, root, 0.5 / root);
}
inline DualLanes sin(const DualLanes& x) {
  return DualLanes::chain(x, sin(x.value), cos(x.value));
}
inline DualLanes cos(const DualLanes& x) {
  return DualLanes::chain(x, cos(x.value), -sin(x.value));
}
inline DualLanes exp(const DualLanes& x) {
  const Lanes e = exp(x.value);
  return DualLanes::chain(x, e, e);
}
inline DualLanes log(const DualLanes& x) {
  return DualLanes::chain(x, log(x.value), 1.0 / x.value);
}
// For x > 0, or x ≥ 0 with an exponent ≥ 1.
inline DualLanes pow(const DualLanes& x, double exponent) {
  return DualLanes::chain(x, pow(x.value, exponent), exponent * pow(x.value, exponent - 1.0));
}
inline DualLanes atan2(const DualLanes& y, const DualLanes& x) {
  const Lanes square = x.value * x.value + y.value * y.value;
  return DualLanes::chain(y, x, atan2(y.value, x.value), x.value / square, -y.value / square);
}
// A function of one variable that is computed from numbers (a table, an iteration). `f` returns its
// value and its slope at one point as {value, slope}.
template <class Function>
Lanes from_values(const Lanes& x, const Function& f) {
  return each_lane(x, [&f](double a) { return f(a)[0]; });
}
template <class Function>
DualLanes from_values(const DualLanes& x, const Function& f) {
  Lanes value, slope;
  for (int i = 0; i < Lanes::count; ++i) {
    const std::array<double, 2> at = f(x.value[i]);
    value.set(i, at[0]);
    slope.set(i, at[1]);
  }
  return DualLanes::chain(x, value, slope);
}

// The values without derivatives, for table look-ups lane by lane.
inline const Lanes& values(const Lanes& x) {
  return x;
}
const Lanes& values(const Lanes&& x) = delete;
inline const Lanes& values(const DualLanes& x) {
  return x.value;
}

template <class T>
using Vec3Of = Eigen::Matrix<T, 3, 1>;
template <class T>
using Mat3Of = Eigen::Matrix<T, 3, 3>;
template <class T>
using QuatOf = Eigen::Quaternion<T>;

// |v| with a minimum of 1e-150, so that v/|v| and the derivatives of |v| to any power remain finite
// at rest, where they are 0.
template <class T>
T length(const Vec3Of<T>& v) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + T(1e-300));
}

}  // namespace photorque

// Eigen's vectors, matrices and quaternions of these scalars.
namespace Eigen {
template <class Scalar>
struct PhotorqueNumTraits : GenericNumTraits<double> {
  using Real = Scalar;
  using NonInteger = Scalar;
  using Nested = Scalar;
  using Literal = double;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 0 };
  enum { ReadCost = 8, AddCost = 8, MulCost = 8 };
};
template <>
struct NumTraits<photorque::Lanes> : PhotorqueNumTraits<photorque::Lanes> {};
template <>
struct NumTraits<photorque::DualLanes> : PhotorqueNumTraits<photorque::DualLanes> {};
}  // namespace Eigen

namespace photorque {

// One lane of a vector.
inline Vec3Of<double> lane_of(const Vec3Of<Lanes>& v, int lane) {
  return {v[0][lane], v[1][lane], v[2][lane]};
}

}  // namespace photorque
