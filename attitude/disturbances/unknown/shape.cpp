#include "attitude/disturbances/unknown/shape.h"

#include <algorithm>

#include "core/errors.h"
#include "core/settings/typed_keys.h"
#include "core/text/format.h"

namespace photorque {

namespace {

constexpr double most_order = 200.0;

constexpr std::array axes_names = {"body", "lab",          "vertical", "lean",
                                   "rate", "rate_by_axis", "command",  "cross_talk"};
constexpr std::array axes_components = {3, 3, 1, 1, 1, 3, 1, 6};
constexpr std::array variable_names = {"yaw", "tilt", "rate", "time", "charge", "command"};
constexpr std::array variable_units = {"deg", "deg", "rad_s", "s", "Ah", "N_m"};
constexpr std::array usual_references = {1.0, 0.1, 0.1, 100.0, 3600.0, 1e-4};

template <class Enum>
size_t index(Enum e) {
  return static_cast<size_t>(e);
}

std::string with_unit(MotionVariable variable, const std::string& what) {
  return name_of(variable) + "_" + what + "_" + unit_of(variable);
}

// The keys of a variable; each selects another form of function.
struct FormKey {
  FunctionForm form;
  std::string key;
};
std::vector<FormKey> form_keys(MotionVariable v) {
  const std::string name = name_of(v);
  if (v == MotionVariable::yaw) return {{FunctionForm::harmonics, "yaw_orders"}};
  std::vector<FormKey> keys = {{FunctionForm::power, name + "_exponent"},
                               {FunctionForm::powers, name + "_powers"},
                               {FunctionForm::table, with_unit(v, "knots")}};
  if (v == MotionVariable::time) {
    keys.push_back({FunctionForm::decay, "time_constant_s"});
    keys.push_back({FunctionForm::harmonics, "time_period_s"});
    keys.push_back({FunctionForm::cosines, "time_span_s"});
  }
  return keys;
}

std::vector<int> read_orders(const Settings& settings, const std::string& key, int least) {
  std::vector<int> orders;
  for (const double x : settings.numbers(key, {static_cast<double>(least), most_order})) {
    const int order = static_cast<int>(x);
    if (static_cast<double>(order) != x || (!orders.empty() && order <= orders.back())) {
      throw settings.error(key, "other numbers", "whole numbers that rise");
    }
    orders.push_back(order);
  }
  if (orders.empty()) throw settings.error(key, "an empty array", "whole numbers that rise");
  return orders;
}

SmoothTable read_knots(const Settings& settings, const std::string& key) {
  const std::vector<double> knots = settings.numbers(key);
  // Slopes between closer knots are dominated by rounding errors.
  constexpr double least_step = 1e-9;  // of the range
  const bool rise = std::adjacent_find(knots.begin(), knots.end(), [&](double a, double b) {
                      return !(b - a >= least_step * (knots.back() - knots.front()) && b > a);
                    }) == knots.end();
  if (knots.size() < 4 || knots.size() > 1000 || !rise) {
    throw settings.error(key, "an array of " + std::to_string(knots.size()),
                         "4 to 1000 numbers that rise, by 1e-9 of their range at least");
  }
  return SmoothTable(knots);
}

MotionFunction read_function(const Settings& settings, MotionVariable variable,
                             const FormKey& form) {
  MotionFunction f;
  f.of = variable;
  f.form = form.form;
  f.reference = usual_reference(variable);
  const std::string reference = with_unit(variable, "reference");
  switch (form.form) {
    case FunctionForm::harmonics:
      if (variable == MotionVariable::yaw) {
        f.orders = read_orders(settings, form.key, 1);
        return f;
      }
      f.own = settings.uncertain(form.key, Range::positive()).value;
      f.orders = read_orders(settings, "time_orders", 0);
      break;
    case FunctionForm::power:
      f.own = settings.uncertain(form.key, Range::positive()).value;
      f.reference = settings.number_or(reference, f.reference, Range::positive());
      break;
    case FunctionForm::powers:
      f.orders = read_orders(settings, form.key, variable == MotionVariable::time ? 0 : 1);
      f.reference = settings.number_or(reference, f.reference, Range::positive());
      break;
    case FunctionForm::decay:
      f.own = settings.uncertain(form.key, Range::positive()).value;
      break;
    case FunctionForm::cosines:
      f.reference = settings.number(form.key, Range::positive());
      f.orders = read_orders(settings, "time_cosines", 0);
      break;
    case FunctionForm::table:
      f.table = read_knots(settings, form.key);
      f.range = {f.table.knots().front(), f.table.knots().back()};
      return f;
  }
  const std::string range = with_unit(variable, "range");
  if (!settings.has(range)) return f;
  const std::vector<double> ends = settings.numbers(range);
  if (ends.size() != 2 || !(ends[1] > ends[0])) {
    throw settings.error(range, "other numbers", "two numbers that rise");
  }
  f.range = {ends[0], ends[1]};
  return f;
}

std::vector<TorqueAxes> read_axes(const Settings& settings) {
  std::vector<TorqueAxes> all;
  for (const std::string& word : settings.texts("axes")) {
    const auto at = std::find(axes_names.begin(), axes_names.end(), word);
    const auto axes = static_cast<TorqueAxes>(at - axes_names.begin());
    if (at == axes_names.end() || std::find(all.begin(), all.end(), axes) != all.end()) {
      throw settings.error("axes", "\"" + word + "\"",
                           "body, lab, vertical, lean, rate, rate_by_axis, command or cross_talk, "
                           "each once");
    }
    all.push_back(axes);
  }
  if (all.empty()) throw settings.error("axes", "an empty array", "one of the axes");
  return all;
}

// Some axes are undefined where a variable is zero, so a function of this variable, which vanishes
// there, is required.
void require_functions(const Settings& settings, const EmpiricalShape& shape) {
  const auto needs = [&](TorqueAxes axes, MotionVariable variable) {
    if (std::find(shape.axes.begin(), shape.axes.end(), axes) == shape.axes.end()) return;
    for (const MotionFunction& f : shape.functions) {
      if (f.of == variable) return;
    }
    throw settings.error("axes",
                         "\"" + name_of(axes) + "\" without a function of the " + name_of(variable),
                         "one, as this axis has no direction where that is zero");
  };
  needs(TorqueAxes::lean, MotionVariable::tilt);
  needs(TorqueAxes::rate, MotionVariable::rate);
  needs(TorqueAxes::rate_by_axis, MotionVariable::rate);
  needs(TorqueAxes::command, MotionVariable::command);
  needs(TorqueAxes::cross_talk, MotionVariable::command);
}

// The key of the harmonics of the yaw that the user wrote. "heading_orders" is the name in earlier
// files improved.toml.
std::string yaw_key(const Settings& settings) {
  return settings.has("heading_orders") ? "heading_orders" : "yaw_orders";
}

std::string array_of(const std::vector<double>& values_SI, double unit) {
  const auto number = [unit](double x) { return printed("%.15g", x / unit); };
  return "[" + joined_text(values_SI, ", ", number) + "]";
}

std::string array_of(const std::vector<int>& values) {
  return "[" + joined_text(values, ", ", [](int x) { return std::to_string(x); }) + "]";
}

// Keys of all variables, one property after the other, so that documents show each property once.
std::vector<Key> function_keys() {
  std::vector<Key> exponents, powers, knots, references, ranges;
  for (const MotionVariable variable :
       {MotionVariable::tilt, MotionVariable::rate, MotionVariable::charge, MotionVariable::command,
        MotionVariable::time}) {
    const std::string name = name_of(variable), unit = "_" + unit_of(variable);
    const double least_power = variable == MotionVariable::time ? 0.0 : 1.0;
    exponents.push_back(UncertainNumberKey(name + "_exponent", Range::positive(),
                                           "exponent of a power of the variable; *or*",
                                           {.optional = true}));
    powers.push_back(NumbersKey(
        name + "_powers", {least_power, most_order},
        "integer powers of the variable in rising order, one term each; *or*", {.optional = true}));
    knots.push_back(
        NumbersKey(name + "_knots" + unit, {},
                   "knots of a smooth table over the variable: at least 4, in rising order, one "
                   "coefficient for each; cubic in between",
                   {.optional = true}));
    references.push_back(NumberKey(name + "_reference" + unit, usual_reference(variable),
                                   Range::positive(), name + " at which the powers are 1"));
    ranges.push_back(NumbersKey(
        name + "_range" + unit, {},
        "[from, to]: measured range. Beyond it the variable is constant, after a smooth transition "
        "of at most a twentieth of the range",
        {.usually = "everywhere; of a table its knots", .size = 2}));
  }
  return joined({exponents, powers, knots, references, ranges});
}

}  // namespace

size_t components_of(TorqueAxes axes) {
  return static_cast<size_t>(axes_components[index(axes)]);
}
std::string name_of(TorqueAxes axes) {
  return axes_names[index(axes)];
}
std::string name_of(MotionVariable variable) {
  return variable_names[index(variable)];
}
std::string unit_of(MotionVariable variable) {
  return variable_units[index(variable)];
}
double usual_reference(MotionVariable variable) {
  return usual_references[index(variable)];
}

size_t MotionFunction::terms() const {
  switch (form) {
    case FunctionForm::harmonics:
      return 2 * orders.size() - (orders.front() == 0 ? 1 : 0);
    case FunctionForm::power:
    case FunctionForm::decay:
      return 1;
    case FunctionForm::powers:
    case FunctionForm::cosines:
      return orders.size();
    case FunctionForm::table:
      break;
  }
  return table.knots().size();
}

std::string MotionFunction::own_key() const {
  if (form == FunctionForm::power) return name_of(of) + "_exponent";
  if (form == FunctionForm::decay) return "time_constant_s";
  const bool periodic = form == FunctionForm::harmonics && of == MotionVariable::time;
  return periodic ? "time_period_s" : "";
}

size_t EmpiricalShape::components() const {
  size_t sum = 0;
  for (const TorqueAxes a : axes) sum += components_of(a);
  return sum;
}

size_t EmpiricalShape::terms() const {
  size_t product = 1;
  for (const MotionFunction& f : functions) product *= f.terms();
  return product;
}

size_t EmpiricalShape::first_coefficient() const {
  return static_cast<size_t>(std::count_if(functions.begin(), functions.end(),
                                           [](const auto& f) { return !f.own_key().empty(); }));
}

EmpiricalShape read_shape(const Settings& settings) {
  EmpiricalShape shape;
  shape.axes = read_axes(settings);
  for (size_t v = 0; v < variable_names.size(); ++v) {
    const auto variable = static_cast<MotionVariable>(v);
    std::string known;
    for (FormKey form : form_keys(variable)) {
      if (variable == MotionVariable::yaw) form.key = yaw_key(settings);
      if (!settings.has(form.key)) continue;
      if (!known.empty()) {
        throw settings.error(form.key, "this beside " + known, "one function of a variable");
      }
      known = form.key;
      shape.functions.push_back(read_function(settings, variable, form));
    }
  }
  if (shape.functions.empty() || shape.functions.size() > 2) {
    throw settings.error("kind", std::to_string(shape.functions.size()) + " functions",
                         "one or two, by yaw_orders, tilt_exponent, rate_exponent, "
                         "time_constant_s and the like");
  }
  require_functions(settings, shape);
  return shape;
}

std::vector<std::pair<std::string, std::string>> shape_as_written(const EmpiricalShape& shape) {
  std::string axes;
  for (const TorqueAxes a : shape.axes) axes += (axes.empty() ? "\"" : ", \"") + name_of(a) + "\"";
  std::vector<std::pair<std::string, std::string>> keys = {{"axes", "[" + axes + "]"}};
  for (const MotionFunction& f : shape.functions) {
    const double unit = unit_of_key(with_unit(f.of, "range")).to_SI;
    const auto add = [&](const std::string& key, const std::string& value) {
      keys.emplace_back(key, value);
    };
    const bool is_power = f.form == FunctionForm::power || f.form == FunctionForm::powers;
    if (is_power) add(with_unit(f.of, "reference"), printed("%.15g", f.reference / unit));
    if (f.form == FunctionForm::powers) add(name_of(f.of) + "_powers", array_of(f.orders));
    if (f.form == FunctionForm::harmonics) add(name_of(f.of) + "_orders", array_of(f.orders));
    if (f.form == FunctionForm::cosines) {
      add("time_span_s", printed("%.15g", f.reference));
      add("time_cosines", array_of(f.orders));
    }
    if (f.form == FunctionForm::table) {
      add(with_unit(f.of, "knots"), array_of(f.table.knots(), unit));
    } else if (f.range) {
      add(with_unit(f.of, "range"), array_of({(*f.range)[0], (*f.range)[1]}, unit));
    }
  }
  return keys;
}

SmoothTable::SmoothTable(std::vector<double> knots) : knots_(std::move(knots)) {
  bool good = knots_.size() >= 4;
  for (size_t i = 1; good && i < knots_.size(); ++i) good = knots_[i] > knots_[i - 1];
  if (!good) throw NumericalError("a smooth table needs four rising knots");
  for (size_t i = 0; i < knots_.size(); ++i) slopes_.push_back(slope_at(i));
}

// Slope of the parabola through three values (Lagrange) at one of their knots.
SmoothTable::Slope SmoothTable::slope_at(size_t knot) const {
  Slope slope;
  slope.first = std::clamp<size_t>(knot, 1, knots_.size() - 2) - 1;
  for (size_t j = 0; j < 3; ++j) {
    double numerator = 0.0, denominator = 1.0;
    for (size_t k = 0; k < 3; ++k) {
      if (k == j) continue;
      denominator *= knots_[slope.first + j] - knots_[slope.first + k];
      // d/dx of the product of (x − x_k) leaves the other factor.
      const size_t other = 3 - j - k;
      numerator += knots_[knot] - knots_[slope.first + other];
    }
    slope.weight[j] = numerator / denominator;
  }
  return slope;
}

SmoothTable::Weights SmoothTable::at(double x) const {
  const auto above = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, x);
  const auto i = static_cast<size_t>(above - knots_.begin()) - 1;
  const double h = knots_[i + 1] - knots_[i], t = (x - knots_[i]) / h;
  const size_t first = std::min(i == 0 ? 0 : i - 1, knots_.size() - 4);
  Weights w;
  w.first = static_cast<int>(first);
  const auto add = [&](size_t knot, double value, double slope) {
    w.value[knot - first] += value;
    w.slope[knot - first] += slope;
  };
  const double t2 = t * t, t3 = t2 * t;
  add(i, 1.0 - 3.0 * t2 + 2.0 * t3, (6.0 * t2 - 6.0 * t) / h);
  add(i + 1, 3.0 * t2 - 2.0 * t3, (6.0 * t - 6.0 * t2) / h);
  for (size_t k = 0; k < 3; ++k) {
    const Slope &left = slopes_[i], &right = slopes_[i + 1];
    add(left.first + k, left.weight[k] * h * (t - 2.0 * t2 + t3),
        left.weight[k] * (1.0 - 4.0 * t + 3.0 * t2));
    add(right.first + k, right.weight[k] * h * (t3 - t2), right.weight[k] * (3.0 * t2 - 2.0 * t));
  }
  return w;
}

std::vector<Key> empirical_shape_keys() {
  return joined(
      {{TextsKey(
            "axes",
            "axes of the torque, each at most once: `\"body\"` x, y, z; `\"lab\"` x, y, z; "
            "`\"vertical\"`; `\"lean\"` (the tilt axis; positive: reduces the tilt); `\"rate\"` "
            "(against the rate if positive); `\"rate_by_axis\"` (the same about body x, y, z); "
            "`\"command\"`; `\"cross_talk\"` (of the command about the other axes: xy, xz, yx, yz, "
            "zx, zy)"),
        NumbersKey("yaw_orders", {1.0, most_order},
                   "integers n in rising order: cos nψ and sin nψ of the yaw ψ (azimuth of body x) "
                   "for each n",
                   {.optional = true})},
       function_keys(),
       {UncertainNumberKey("time_constant_s", Range::positive(),
                           "time constant τ of a factor exp(−t/τ); *or*", {.optional = true}),
        UncertainNumberKey("time_period_s", Range::positive(),
                           "period of the sines and cosines of `time_orders`", {.optional = true}),
        NumbersKey("time_orders", {0.0, most_order},
                   "integers n in rising order: cos and sin of 2π n t/period for each n (0: a "
                   "constant); *or*",
                   {.optional = true}),
        NumberKey("time_span_s", Range::positive(), "span of the cosines of `time_cosines`",
                  {.optional = true}),
        NumbersKey("time_cosines", {0.0, most_order},
                   "integers n in rising order: cos(π n t/span) for each n", {.optional = true}),
        UncertainNumberKey(empirical_coefficients, {},
                           "one coefficient for each combination, the last index fastest: term of "
                           "the first variable, term of the second variable, component of the "
                           "axes; at most 200 numbers are practical",
                           {.several = true})}});
}

}  // namespace photorque
