#include "python/bindings/torque.h"

#include <pybind11/numpy.h>

#include <array>
#include <cmath>

namespace photorque::python {
namespace {

using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Inputs of a law: time, quaternion (w, x, y, z), angular rate.
constexpr size_t variables = 8;
using Variables = std::array<double, variables>;
using Torque = std::array<double, 3>;

// Evaluation of the function at many instants.
class Evaluation {
 public:
  Evaluation(std::string name, py::object function, Call::Failing failing)
      : name_(std::move(name)), function_(std::move(function)), failing_(std::move(failing)) {}

  // Called by the library without the interpreter's lock.
  std::vector<Torque> operator()(const std::vector<Variables>& instants) const {
    const py::gil_scoped_acquire lock;
    try {
      return evaluate(instants);
    } catch (py::error_already_set& error) {
      failing_(std::move(error));
    }
    return {};  // not reached: failing_ throws
  }

 private:
  std::vector<Torque> evaluate(const std::vector<Variables>& instants) const {
    const auto count = static_cast<py::ssize_t>(instants.size());
    py::array_t<double> time_s(count);
    py::array_t<double> attitude({count, py::ssize_t{4}}), rate({count, py::ssize_t{3}});
    for (py::ssize_t i = 0; i < count; ++i) {
      const Variables& x = instants[static_cast<size_t>(i)];
      time_s.mutable_at(i) = x[0];
      for (py::ssize_t k = 0; k < 4; ++k) attitude.mutable_at(i, k) = x[static_cast<size_t>(1 + k)];
      for (py::ssize_t k = 0; k < 3; ++k) rate.mutable_at(i, k) = x[static_cast<size_t>(5 + k)];
    }
    const Rows torques = Rows::ensure(function_(time_s, attitude, rate));
    if (!torques) fail("gave no array of numbers");
    if (torques.ndim() != 2 || torques.shape(0) != count || torques.shape(1) != 3) refuse(torques);
    std::vector<Torque> result(instants.size());
    for (py::ssize_t i = 0; i < count; ++i) {
      for (py::ssize_t k = 0; k < 3; ++k) {
        const double value = torques.at(i, k);
        if (!std::isfinite(value)) fail("gave a number that is not finite");
        result[static_cast<size_t>(i)][static_cast<size_t>(k)] = value;
      }
    }
    return result;
  }
  [[noreturn]] void refuse(const py::array& torques) const {
    fail("gave an array of shape " + std::string(py::str(torques.attr("shape"))) +
         ", expected (n, 3), a row for each time");
  }
  [[noreturn]] void fail(const std::string& what) const {
    PyErr_SetString(PyExc_ValueError, ("torque \"" + name_ + "\" " + what).c_str());
    throw py::error_already_set();
  }

  std::string name_;
  py::object function_;
  Call::Failing failing_;
};

class OwnTorque final : public TorqueLaw<OwnTorque> {
 public:
  explicit OwnTorque(Evaluation evaluate) : evaluate_(std::move(evaluate)) {}

  Vec3Of<Lanes> torque(const ParametersAndStates<Lanes>&,
                       const EvaluationContext<Lanes>& now) const {
    const std::vector<Torque> torques = evaluate_(instants_of(variables_of(now)));
    Vec3Of<Lanes> result = Vec3Of<Lanes>::Constant(Lanes(0.0));
    for (int i = 0; i < Lanes::count; ++i) {
      for (int k = 0; k < 3; ++k) {
        result[k].set(i, torques[static_cast<size_t>(i)][static_cast<size_t>(k)]);
      }
    }
    return result;
  }

  // Derivatives by central differences in every variable, in a single call.
  Vec3Of<DualLanes> torque(const ParametersAndStates<DualLanes>&,
                           const EvaluationContext<DualLanes>& now) const {
    const std::array<DualLanes, variables> x = variables_of(now);
    std::array<Lanes, variables> values;
    for (size_t v = 0; v < variables; ++v) values[v] = x[v].value;
    std::vector<Variables> instants = instants_of(values);
    const size_t count = instants.size();
    for (size_t v = 0; v < variables; ++v) {
      for (const double sign : {1.0, -1.0}) {
        for (size_t i = 0; i < count; ++i) {
          Variables moved = instants[i];
          moved[v] += sign * step;
          instants.push_back(moved);
        }
      }
    }
    const std::vector<Torque> torques = evaluate_(instants);
    Vec3Of<DualLanes> result;
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](size_t block) { return lanes_of(torques, block * count, k); };
      DualLanes sum(at(0));
      for (size_t v = 0; v < variables; ++v) {
        const Lanes slope = (0.5 / step) * (at(1 + 2 * v) - at(2 + 2 * v));
        sum += DualLanes::chain(x[v], 0.0, slope);
      }
      result[k] = sum;
    }
    return result;
  }

 private:
  // Step in seconds, quaternion components and rad/s: about the cube root of the rounding error.
  static constexpr double step = 1e-5;

  template <class T>
  static std::array<T, variables> variables_of(const EvaluationContext<T>& now) {
    const QuatOf<T>& q = now.attitude;
    const Vec3Of<T>& rate = now.rate_body_rad_s;
    return {now.time_s, q.w(), q.x(), q.y(), q.z(), rate[0], rate[1], rate[2]};
  }
  static std::vector<Variables> instants_of(const std::array<Lanes, variables>& x) {
    std::vector<Variables> instants(Lanes::count);
    for (int i = 0; i < Lanes::count; ++i) {
      for (size_t v = 0; v < variables; ++v) instants[static_cast<size_t>(i)][v] = x[v][i];
    }
    return instants;
  }
  static Lanes lanes_of(const std::vector<Torque>& torques, size_t first, int component) {
    Lanes lanes(0.0);
    for (int i = 0; i < Lanes::count; ++i) {
      lanes.set(i, torques[first + static_cast<size_t>(i)][static_cast<size_t>(component)]);
    }
    return lanes;
  }

  Evaluation evaluate_;
};

}  // namespace

Disturbance own_torque(const std::string& name, const py::object& function, const Call& call) {
  Disturbance disturbance;
  disturbance.kind = name;
  disturbance.law = std::make_shared<const OwnTorque>(Evaluation(name, function, call.failing()));
  return disturbance;
}

}  // namespace photorque::python
