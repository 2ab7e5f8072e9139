#include <algorithm>
#include <cmath>
#include <utility>

#include "attitude/model/platform.h"
#include "core/constants.h"
#include "core/text/format.h"
#include "diagnosis/attitude/findings.h"

namespace photorque {
namespace {

// Access to parameters by their index in the law.
class Numbers {
 public:
  Numbers(const EmpiricalShape& shape, const std::vector<FittedParameter>& parameters,
          const Eigen::MatrixXd& covariance)
      : first_(shape.first_coefficient()), covariance_(covariance) {
    for (const FittedParameter& p : parameters) {
      for (size_t i = 0; i < p.value.size(); ++i) {
        value_.push_back(p.value[i]);
        sigma_.push_back(i < p.sigma.size() ? p.sigma[i] : 0.0);
      }
    }
  }
  // Exponent, time constant or period of a function, as text.
  std::string own(size_t function) const { return with_error(value_[function], sigma_[function]); }
  double own_value(size_t function) const { return value_[function]; }
  double coefficient(size_t k) const { return value_[first_ + k]; }
  double sigma(size_t k) const { return sigma_[first_ + k]; }
  std::string text(size_t k, double unit = 1.0) const {
    return with_error(coefficient(k) / unit, sigma(k) / unit);
  }
  bool counts(size_t k) const { return std::abs(coefficient(k)) > 3.0 * sigma(k); }

  // a cos x + b sin x = A cos(x − φ), with the errors of A and φ.
  struct Wave {
    double size, size_sigma, phase_rad, phase_sigma_rad;
  };
  Wave wave(size_t a, size_t b) const {
    const double x = coefficient(a), y = coefficient(b), size = std::hypot(x, y);
    const auto i = static_cast<Eigen::Index>(first_ + a), j = static_cast<Eigen::Index>(first_ + b);
    const Eigen::Matrix2d C{{covariance_(i, i), covariance_(i, j)},
                            {covariance_(j, i), covariance_(j, j)}};
    const Eigen::Vector2d along(x / size, y / size), across(-y / size, x / size);
    return {size, std::sqrt(along.dot(C * along)), std::atan2(y, x),
            std::sqrt(across.dot(C * across)) / size};
  }

 private:
  size_t first_;
  const Eigen::MatrixXd& covariance_;
  std::vector<double> value_, sigma_;
};

// "(4.41 ± 0.02)×10⁻⁶ N m cos(3 ψ − (94.9 ± 0.3)°)".
std::string wave_text(const Numbers& numbers, size_t a, size_t b, double unit,
                      const std::string& unit_text, const std::string& angle) {
  const Numbers::Wave wave = numbers.wave(a, b);
  return with_error(wave.size / unit, wave.size_sigma / unit) + " " + unit_text + " cos(" + angle +
         " − " + with_error(wave.phase_rad / degree_rad, wave.phase_sigma_rad / degree_rad) + "°)";
}

std::string times(int order, const std::string& symbol) {
  return order == 1 ? symbol : std::to_string(order) + " " + symbol;
}

const char* direction_of(TorqueAxes axes) {
  constexpr const char* directions[] = {
      "about body x, y, z", "about lab x, y, z",
      "about the vertical", "about the tilt axis; positive: reduces the tilt",
      "against the rate",   "against the rate about body x, y, z",
      "along the command",  "of the command about the other axes, xy, xz, yx, yz, zx, zy"};
  return directions[static_cast<size_t>(axes)];
}

// The coefficients of one term about all axes: "(1 ± 0.1)×10⁻⁶ N m FUNCTION about the vertical".
std::string by_axes(const EmpiricalShape& shape, const Numbers& numbers,
                    const std::string& function) {
  size_t largest = 0;
  const size_t count = shape.components();
  for (size_t k = 0; k < count; ++k) {
    if (std::abs(numbers.coefficient(k)) > std::abs(numbers.coefficient(largest))) largest = k;
  }
  std::string text;
  size_t at = 0;
  for (const TorqueAxes axes : shape.axes) {
    const size_t n = components_of(axes);
    bool counts = false;
    std::string list;
    for (size_t k = at; k < at + n; ++k) {
      counts = counts || numbers.counts(k) || k == largest;
      list += (k == at ? "" : ", ") + numbers.text(k);
    }
    at += n;
    if (!counts) continue;
    text += (text.empty() ? "T = " : "; and ") + (n == 1 ? list : "[" + list + "]") + " N m " +
            function + " " + direction_of(axes);
  }
  return text;
}

std::string reference_text(const MotionFunction& f) {
  switch (f.of) {
    case MotionVariable::tilt:
      return readable_number(f.reference, 3) + " rad";
    case MotionVariable::rate:
      return readable_number(f.reference, 3) + " rad/s";
    case MotionVariable::charge:
      return readable_number(f.reference / 3600.0, 3) + " Ah";
    case MotionVariable::command:
      return readable_number(f.reference, 3) + " N m";
    default:
      return readable_number(f.reference, 3) + " s";
  }
}

const char* symbol_of(MotionVariable variable) {
  constexpr const char* symbols[] = {"ψ", "θ", "|ω|", "t", "q", "|c|"};
  return symbols[static_cast<size_t>(variable)];
}

const char* meaning_of(MotionVariable variable) {
  constexpr const char* meanings[] = {"ψ the yaw",          "θ the tilt",
                                      "ω the rate",         "t the recording's time",
                                      "q the charge drawn", "c the command"};
  return meanings[static_cast<size_t>(variable)];
}

std::string ratio(const MotionFunction& f) {
  return "(" + std::string(symbol_of(f.of)) + "/" + reference_text(f) + ")";
}

std::string of_one(const EmpiricalShape& shape, const Numbers& numbers) {
  const MotionFunction& f = shape.functions.front();
  switch (f.form) {
    case FunctionForm::harmonics:
      if (f.orders.size() != 1 || shape.components() != 1) return "";
      return "T = " +
             wave_text(numbers, 0, 1, 1.0, "N m",
                       times(f.orders[0],
                             f.of == MotionVariable::yaw ? "ψ" : "2π t/" + numbers.own(0) + " s")) +
             " " + direction_of(shape.axes.front());
    case FunctionForm::power:
      return by_axes(shape, numbers, ratio(f) + "^" + numbers.own(0));
    case FunctionForm::powers: {
      if (f.orders.size() != 1) return "";
      const std::string order = f.orders[0] == 1 ? "" : "^" + std::to_string(f.orders[0]);
      return by_axes(shape, numbers, ratio(f) + order);
    }
    case FunctionForm::decay:
      return by_axes(shape, numbers, "exp(−t/" + numbers.own(0) + " s)");
    case FunctionForm::cosines:
    case FunctionForm::table:
      break;
  }
  return "";
}

// Formula of a drag that varies with the state.
std::string of_drag(const EmpiricalShape& shape, const Numbers& numbers) {
  const MotionFunction &f = shape.functions[0], &rate = shape.functions[1];
  const bool is_linear = rate.of == MotionVariable::rate && rate.form == FunctionForm::powers &&
                         rate.orders == std::vector<int>{1};
  if (!is_linear || shape.axes != std::vector{TorqueAxes::rate}) return "";
  if (f.form == FunctionForm::harmonics && f.orders.size() == 1) {
    return "T = −ω " + wave_text(numbers, 0, 1, rate.reference, "N m s", times(f.orders[0], "ψ"));
  }
  if (f.form != FunctionForm::powers) return "";
  std::string text;
  for (size_t k = 0; k < f.orders.size(); ++k) {
    if (!numbers.counts(k) && f.orders.size() > 1) continue;
    const std::string order = f.orders[k] == 1 ? "" : "^" + std::to_string(f.orders[k]);
    text += (text.empty() ? "T = −ω (" : " + ") + numbers.text(k, rate.reference) + " N m s " +
            ratio(f) + order;
  }
  return text.empty() ? "" : text + ")";
}

std::string similar_yaw_effect(const MotionFunction& f) {
  switch (f.orders.front()) {
    case 1:
      return "a fixed direction in the room: a draught from one side, a magnet or iron beside the "
             "platform, a bearing that is not level, a cable that pulls to one side";
    case 2:
      return "a bearing that is slightly elliptic, or soft iron in the field";
    case 3:
      return "three pads, feeding holes or feet of the bearing";
    default:
      return "as many pads, feeding holes or magnetic poles of the bearing, or a multiple of "
             "their number";
  }
}

std::string similar_effects(const EmpiricalShape& shape, const Numbers& numbers) {
  const MotionFunction& f = shape.functions.front();
  if (shape.functions.size() == 2) {
    return f.of == MotionVariable::yaw
               ? "a bearing whose gap varies along the circumference, or that rubs over part of a "
                 "turn"
               : "an air film that becomes thinner on one side when the platform is tilted";
  }
  switch (f.of) {
    case MotionVariable::yaw:
      return similar_yaw_effect(f);
    case MotionVariable::tilt:
      if (f.form == FunctionForm::table) {
        return "a stop, seal or cable that is reached at a certain tilt";
      }
      return "a cable or hose that stiffens as it bends, a bearing whose centre moves with the "
             "tilt, contact near the rim";
    case MotionVariable::rate:
      if (f.form == FunctionForm::power && numbers.own_value(0) > 2.5) {
        return "air that is thrown out or pumped, parts that bend outwards with the rate";
      }
      return "drag that differs between the three axes: plates, cables, the bearing";
    case MotionVariable::time:
      if (f.form == FunctionForm::decay) {
        return "evaporation or outgassing, warming up, a draught or a supply pressure that "
               "settles, "
               "a cable that creeps";
      }
      if (f.form == FunctionForm::harmonics) {
        return "a pump, heater or compressor that switches on and off";
      }
      return "draughts of the room, people who walk, a cable that sags or creeps";
    case MotionVariable::charge:
      return "mass that moves in the battery, gas that is consumed with the charge, the magnetic "
             "field of the leads";
    case MotionVariable::command:
      return shape.axes.front() == TorqueAxes::cross_talk
                 ? "actuators that are rotated from the body axes, or that affect each other"
                 : "actuators whose torque is not proportional to the command";
  }
  return "";
}

constexpr size_t torque_bins = 36;
constexpr size_t propagated_states = 1000;

struct Abscissa {
  std::string unit;
  bool lab_axes = false;  // whether the torque is given in lab axes
};

Abscissa abscissa_of(const std::string& variable) {
  if (variable == "yaw") return {"deg", true};
  if (variable == "tilt") return {"deg"};
  if (variable == "rate") return {"rad/s"};
  if (variable == "charge") return {"C"};
  if (variable == "command") return {"N m"};
  return {"s"};
}

double value_of(const std::string& variable, const AttitudeModel& model,
                const PlatformState& state) {
  if (variable == "yaw") return yaw_rad(state) / degree_rad;
  if (variable == "tilt") return tilt_rad(state) / degree_rad;
  if (variable == "rate") return state.rate_body_rad_s.norm();
  if (variable == "charge") return state.charge_drawn_C;
  if (variable == "command") return model.schedule.at(state.time_s).command_body_N_m.norm();
  return state.time_s;
}

// Torque of the law at one state, and its derivatives with respect to the parameters.
struct TorqueAndSlopes {
  Vec3 torque_N_m = Vec3::Zero();
  Eigen::Matrix3Xd slopes;
};

// `model` contains only the law and is unchanged on return. The law is linear in its coefficients,
// so their slopes are the torques of unit coefficients. Slopes of exponents and time constants are
// finite differences.
TorqueAndSlopes at_state(AttitudeModel& model, size_t own, const PlatformState& state) {
  auto& parameters = model.disturbances.front().parameters;
  const auto torque = [&] { return disturbance_torques_body_N_m(model, state).front(); };
  TorqueAndSlopes result;
  result.torque_N_m = torque();
  result.slopes.resize(3, static_cast<Eigen::Index>(parameters.size()));
  for (size_t p = 0; p < own; ++p) {
    const double value = parameters[p].value, step = 1e-4 * value;
    parameters[p].value = value + step;
    const Vec3 above = torque();
    parameters[p].value = value - step;
    result.slopes.col(static_cast<Eigen::Index>(p)) = (above - torque()) / (2.0 * step);
    parameters[p].value = value;
  }
  std::vector<double> values;
  for (size_t p = own; p < parameters.size(); ++p) {
    values.push_back(std::exchange(parameters[p].value, 0.0));
  }
  for (size_t p = own; p < parameters.size(); ++p) {
    parameters[p].value = 1.0;
    result.slopes.col(static_cast<Eigen::Index>(p)) = torque();
    parameters[p].value = 0.0;
  }
  for (size_t p = own; p < parameters.size(); ++p) parameters[p].value = values[p - own];
  return result;
}

// Covariance of all `count` parameters of a law; 0 for fixed ones, such as the torque about an axis
// that cannot turn.
Eigen::MatrixXd covariance_of(const Fit& fit, size_t law, Eigen::Index count) {
  const Eigen::MatrixXd shared = fit.shared_posterior();
  std::vector<Eigen::Index> fitted, where;
  for (const SharedParameter& s : fit.best.shared(law)) {
    fitted.push_back(static_cast<Eigen::Index>(s.parameter));
    where.push_back(s.at);
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  covariance(fitted, fitted) = shared(where, where);
  return covariance;
}

EmpiricalTorque torque_of(const Trial& chosen, size_t which, const Candidate& candidate,
                          const AttitudeModel& model, const Trajectory& propagated) {
  const size_t law = chosen.disturbances[which];
  const Abscissa abscissa = abscissa_of(candidate.variable);
  EmpiricalTorque torque;
  torque.variable = candidate.variable;
  torque.unit = abscissa.unit;
  torque.about_lab_axes = abscissa.lab_axes;

  std::vector<double> x;
  for (const PlatformState& state : propagated.states) {
    x.push_back(value_of(candidate.variable, model, state));
  }
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  const double width = std::max((*high - *low) / torque_bins, 1e-300);
  AttitudeModel alone = model;
  alone.disturbances = {model.disturbances[law]};
  const auto count = static_cast<Eigen::Index>(alone.disturbances.front().parameters.size());
  std::vector<Eigen::Matrix3Xd> slopes(torque_bins, Eigen::Matrix3Xd::Zero(3, count));
  std::vector<Vec3> sum(torque_bins, Vec3::Zero());
  std::vector<double> samples(torque_bins, 0.0);
  for (size_t k = 0; k < x.size(); ++k) {
    const PlatformState& state = propagated.states[k];
    const auto bin = std::min(torque_bins - 1, static_cast<size_t>((x[k] - *low) / width));
    const TorqueAndSlopes at = at_state(alone, candidate.law.shape.first_coefficient(), state);
    const Mat3 turn =
        abscissa.lab_axes ? Mat3(state.lab_from_body.toRotationMatrix()) : Mat3::Identity();
    sum[bin] += turn * at.torque_N_m;
    slopes[bin] += turn * at.slopes;
    samples[bin] += 1.0;
  }

  const Eigen::MatrixXd covariance = covariance_of(chosen.fit, law, count);
  for (size_t bin = 0; bin < torque_bins; ++bin) {
    if (samples[bin] == 0.0) continue;
    const Eigen::Matrix3Xd slope = slopes[bin] / samples[bin];
    torque.at.push_back(*low + (static_cast<double>(bin) + 0.5) * width);
    torque.torque_N_m.emplace_back(sum[bin] / samples[bin]);
    torque.standard_error_N_m.emplace_back(
        (slope * covariance * slope.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt());
  }
  torque.shape = shape_as_written(candidate.law.shape);
  torque.parameters = fitted_parameters(chosen, law);
  const EmpiricalFormula formula = formula_of(candidate.law.shape, torque.parameters, covariance);
  torque.formula = formula.text;
  torque.looks_like = formula.looks_like;
  return torque;
}

}  // namespace

std::string with_error(double value, double sigma) {
  if (!(sigma > 0.0) || !std::isfinite(sigma)) return readable_number(value, 4);
  const auto magnitude = [](double x) { return static_cast<int>(std::floor(std::log10(x))); };
  const int exponent = magnitude(std::max(std::abs(value), sigma));
  const bool plain = exponent >= -2 && exponent <= 4;
  const double unit = plain ? 1.0 : std::pow(10.0, exponent);
  const int decimals = std::clamp(1 - magnitude(sigma / unit), 0, 9);
  return printed("(%.*f ± %.*f)", decimals, value / unit, decimals, sigma / unit) +
         (plain ? "" : "×" + power_of_ten(exponent));
}

EmpiricalFormula formula_of(const EmpiricalShape& shape,
                            const std::vector<FittedParameter>& parameters,
                            const Eigen::MatrixXd& covariance) {
  const Numbers numbers(shape, parameters, covariance);
  EmpiricalFormula formula;
  formula.text = shape.functions.size() == 1 ? of_one(shape, numbers) : of_drag(shape, numbers);
  if (!formula.text.empty()) {
    std::string where;
    for (const MotionFunction& f : shape.functions) {
      where += (where.empty() ? "; " : ", ") + std::string(meaning_of(f.of));
    }
    formula.text += where;
  }
  formula.looks_like = similar_effects(shape, numbers);
  return formula;
}

std::vector<EmpiricalTorque> empirical_torques(const Trial& chosen, const Candidates& all,
                                               const std::vector<Observation>& runs) {
  const AttitudeModel model = chosen.fit.best.model_of(0, runs.front());
  const Dynamics dynamics(model);
  const Trajectory propagated =
      propagate(dynamics, chosen.fit.best.runs.front().initial,
                runs.front().averaged(propagated_states).time_s, {.tolerance = 1e-7});
  std::vector<EmpiricalTorque> result;
  for (size_t i = 0; i < chosen.candidates.size(); ++i) {
    const Candidate& c = all[chosen.candidates[i]];
    if (c.is_empirical) result.push_back(torque_of(chosen, i, c, model, propagated));
  }
  return result;
}

}  // namespace photorque
