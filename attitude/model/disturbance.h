// The interface between the dynamics and everything that acts on the platform.
//
// A disturbance is one file NAME.cpp and the word NAME in CMakeLists.txt. Its law is written once,
// as a template over the scalar type, and runs on Lanes (values at eight instants) and on DualLanes
// (the same with exact derivatives). A short complete file is disturbances/plane/sliding_drag.cpp.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "attitude/environment/environment.h"
#include "attitude/model/platform.h"
#include "core/numerics/dual.h"
#include "core/settings/typed_keys.h"

namespace photorque {

// The stage at which a disturbance acts when an instant is evaluated. Within a stage the order is
// that of the experiment file, and the result must not depend on it.
enum class Stage {
  conditions,   // changes the input of all others: gravity, field, command, inertia
  mass,         // moves the centre of mass, by EvaluationContext::move_mass(), or turns the lab
  torque,       // acts on the body
  measurement,  // changes only the readings of the instruments
};

// The evaluation context: all quantities at eight instants that a disturbance may read, and the
// results to which it may add. Body vectors are in body axes and about the centre of rotation;
// `_lab` vectors are in lab axes.
template <class T>
struct EvaluationContext {
  const Platform& platform;
  const Environment& environment;

  // The state.
  T time_s;
  QuatOf<T> attitude;       // lab from body, unit
  Mat3Of<T> lab_from_body;  // as a matrix
  Vec3Of<T> rate_body_rad_s;
  T charge_drawn_C;

  // Conditions, from platform, environment and schedule; Stage::conditions may change these.
  T mass_kg;
  Mat3Of<T> inertia_kg_m2;  // about the centre of rotation
  Vec3Of<T> gravity_lab_m_s2;
  Vec3Of<T> magnetic_field_lab_T;
  Vec3Of<T> up_lab;         // unit, away from the Earth's centre
  T gravity_gradient_1_s2;  // g/R on the ground, μ/r³ in orbit
  T illumination;           // fraction of the light that arrives: 1 lit, 0 in shadow
  // About the Earth's centre, in inertial axes whose z is the Earth's; zero on the ground.
  Vec3Of<T> orbit_position_lab_m, orbit_velocity_lab_m_s;
  Vec3Of<T> command_body_N_m;       // commanded torque; acts on the body directly
  Vec3Of<T> command_lab_N;          // commanded force on a sliding platform
  T battery_current_A;              // drawn from the battery (positive discharges)
  bool current_is_measured;         // Schedule::current_is_measured
  T led_current_A;                  // ZeroOrderHold::led_current_A
  T lamps_as_stated;                // ZeroOrderHold::lamps_as_stated
  T array_power_W;                  // power that the solar array delivers
  Vec3Of<T> traced_light_body_N_m;  // ZeroOrderHold::light_body at this instant
  Vec3Of<T> wheel_rad_s;            // of wheels about the body's axes, relative to the body
  Vec3Of<T> wheel_rad_s2;           // their acceleration

  // Dry friction about one axis. slip_is_held: 1 if the direction of slip is constant in the step
  // (ZeroOrderHold::slip), 0 if it follows the rate. slip_sign: the constant direction, 0 if the
  // platform sticks.
  T slip_is_held, slip_sign;

  // Position and velocity of a planar platform; zero for all others.
  Vec3Of<T> position_lab_m, velocity_lab_m_s;

  // The conditions in body axes: valid after Stage::conditions.
  Vec3Of<T> gravity_body_m_s2;
  Vec3Of<T> magnetic_field_body_T;
  Vec3Of<T> up_body;

  // Displacement of the centre of mass from the centre of rotation, summed over the laws so far;
  // complete after Stage::mass. Change it with move_mass().
  Vec3Of<T> mass_offset_body_m;

  // Results.
  Vec3Of<T> torque_body_N_m;  // add to it
  Vec3Of<T> force_lab_N;      // on a platform that slides; add to it
  // Inertia that does not turn with the body. Change it with detach_inertia().
  Mat3Of<T> detached_inertia_kg_m2;
  bool inertia_changed = false;  // false: inertia_kg_m2 is the platform's, none is detached
  // The rate relative to the inertial frame, which an ideal gyro measures and which acts on a
  // rotor. earth_rotation adds to it. Complete after Stage::mass.
  Vec3Of<T> inertial_rate_body_rad_s;
  // Stage::measurement adds to these.
  Vec3Of<T> gyro_error_rad_s;  // reading − inertial rate, body axes
  Vec3Of<T> camera_error_rad;  // rotation vector from the true to the observed body axes
  T camera_delay_s;            // the camera reports the attitude this much earlier

  // A lab vector in body axes.
  Vec3Of<T> to_body(const Vec3Of<T>& v_lab) const { return lab_from_body.transpose() * v_lab; }

  // For Stage::conditions: adds to the inertia.
  void change_inertia(const Mat3Of<T>& by_kg_m2) {
    inertia_kg_m2 += by_kg_m2;
    inertia_changed = true;
  }

  // Detaches this part of the inertia, J a aᵀ: it has a separate spring or bearing about the axis a
  // and does not follow the body's acceleration. The law also adds the torque −ω × (J a σ) with the
  // part's absolute rate σ about that axis, and the torque of the spring or motor.
  void detach_inertia(const Mat3Of<T>& part_kg_m2) {
    detached_inertia_kg_m2 += part_kg_m2;
    inertia_changed = true;
  }

  // Moves the centre of mass by `offset_body_m` and adds the torque m r × g that this causes.
  void move_mass(const Vec3Of<T>& offset_body_m) {
    mass_offset_body_m += offset_body_m;
    torque_body_N_m += mass_kg * offset_body_m.cross(gravity_body_m_s2);
  }
};

// A number of a disturbance that can be read, edited and differentiated with respect to.
struct Parameter {
  std::string key;     // as in the experiment file, ends in the unit as written: "shift_m_per_Ah"
  int component = -1;  // of an array, row by row for a matrix; −1: the key is one number
  double value = 0.0;  // SI: multiply by 1/unit_of_key(key).to_SI to show it in the key's unit
  double sigma = 0.0;  // the user's one-sigma uncertainty, SI; 0: exact
};

// A state that a disturbance adds to the attitude and rates.
struct ExtraState {
  std::string name;  // ends in its unit
  double initial = 0.0;
  double scale = 1.0;  // > 0, a deviation of this size matters as much as 1 rad of attitude
  // Additional initial value if the platform starts by turning as one rigid body: this vector times
  // the rate, body axes. For states that are measured relative to the inertial frame.
  Vec3 per_body_rate = Vec3::Zero();
  // Key of an experiment file for `initial`, in the key's unit; empty: none.
  std::string key = {};
  // Whether the angle about the only axis at the start, with whole turns, is added to `initial`.
  bool is_turned_angle = false;
};

// A key of a law, and the position of its numbers among the law's parameters. A law declares its
// keys in their order:
//   constexpr VectorKey torque_N_m("torque_N_m", "amplitude, body axes");
//   constexpr ScalarKey frequency_Hz("frequency_Hz", {0.0, 1e6}, "of it", torque_N_m.end());
// It reads them by these names, own[frequency_Hz], at the cost of an index, and lists them among
// the keys of its kind.
template <int size>
struct KeyOf {
  const char* name;
  int first = 0;
  Range range = {};                         // of one number, SI
  const char* what = "";                    // as Key::what
  std::optional<double> otherwise_SI = {};  // of one number
  bool required = true;

  constexpr explicit KeyOf(const char* key, int first_number = 0)
      : name(key), first(first_number) {}
  constexpr KeyOf(const char* key, const char* sentence, int first_number = 0)
      : name(key), first(first_number), what(sentence) {}
  constexpr KeyOf(const char* key, Range admitted, const char* sentence, int first_number = 0)
      : name(key), first(first_number), range(admitted), what(sentence) {}
  constexpr KeyOf(const char* key, double otherwise, Range admitted, const char* sentence,
                  int first_number = 0)
      : name(key), first(first_number), range(admitted), what(sentence), otherwise_SI(otherwise) {}

  constexpr operator std::string_view() const { return name; }
  constexpr int end() const { return first + size; }
  // The key may be absent.
  constexpr KeyOf optional() const {
    KeyOf copy = *this;
    copy.required = false;
    return copy;
  }
  constexpr KeyOf within(Range admitted) const {
    KeyOf copy = *this;
    copy.range = admitted;
    return copy;
  }

  // The key as declared in the table of keys. Keys of up to six numbers may have a sigma for each.
  operator Key() const requires(size <= 6) {
    KeyTraits traits{.optional = !required, .has_error = true};
    if constexpr (size == 3) return Vec3Key(name, what, traits);
    if constexpr (size > 1) {
      traits.size = size;
      return NumbersKey(name, range, what, traits);
    }
    return otherwise_SI ? UncertainNumberKey(name, {*otherwise_SI, 0.0}, range, what)
                        : UncertainNumberKey(name, range, what, traits);
  }
};
using ScalarKey = KeyOf<1>;
using VectorKey = KeyOf<3>;
using MatrixKey = KeyOf<9>;  // row by row

// A state of a disturbance, and its index.
struct StateKey {
  const char* name;
  int index = 0;
};

// Parameters and states of one disturbance.
template <class T>
struct ParametersAndStates {
  const T* parameters;
  const T* states;  // those of its ExtraStates
  T* state_rates;   // output: d/dt of each state

  const T& operator[](const ScalarKey& key) const { return parameters[key.first]; }
  Vec3Of<T> operator[](const VectorKey& key) const {
    return {parameters[key.first], parameters[key.first + 1], parameters[key.first + 2]};
  }
  Mat3Of<T> operator[](const MatrixKey& key) const {
    Mat3Of<T> m;
    for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = parameters[key.first + i];
    return m;
  }
  // A symmetric matrix: xx, yy, zz, xy, xz, yz.
  Mat3Of<T> operator[](const KeyOf<6>& key) const {
    const T* m = parameters + key.first;
    Mat3Of<T> full;
    full << m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2];
    return full;
  }
  // One number of an array of any length.
  template <int size>
  const T& element(const KeyOf<size>& key, int index) const {
    return parameters[key.first + index];
  }

  const T& state(StateKey key) const { return states[key.index]; }
  T& rate_of(StateKey key) const { return state_rates[key.index]; }
};

// A time at which a law jumps. The propagator ends a step exactly there.
struct Switch {
  double time_s = 0.0;
  int parameter = -1;  // index of the parameter that is this time, −1 if none is
};
// Switches at times that are not parameters.
std::vector<Switch> switches_at(std::span<const double> times_s);

// A law: immutable, without state, called from many threads. It must be smooth between switches; a
// smoother law allows longer steps. Derive from TorqueLaw or LawOf below.
class Law {
 public:
  virtual ~Law() = default;

  virtual void act(const ParametersAndStates<Lanes>& own, EvaluationContext<Lanes>& now) const = 0;
  virtual void act(const ParametersAndStates<DualLanes>& own,
                   EvaluationContext<DualLanes>& now) const = 0;

  // All jumps, in any order; the propagator uses those within the run. A law that jumps uses
  // active_from() or a similar function that treats each lane separately.
  virtual std::vector<Switch> switches(std::span<const Parameter> /*parameters*/) const {
    return {};
  }
};

// For laws that change the evaluation context: Derived has
//   template <class T> void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now)
//   const;
template <class Derived>
class LawOf : public Law {
 public:
  void act(const ParametersAndStates<Lanes>& own, EvaluationContext<Lanes>& now) const final {
    self().apply(own, now);
  }
  void act(const ParametersAndStates<DualLanes>& own,
           EvaluationContext<DualLanes>& now) const final {
    self().apply(own, now);
  }

 private:
  const Derived& self() const { return static_cast<const Derived&>(*this); }
};

// A law without an effect on the evaluation context.
struct NoLaw final : LawOf<NoLaw> {
  template <class T>
  void apply(const ParametersAndStates<T>&, EvaluationContext<T>&) const {}
};

// For laws that are only a torque: Derived has
//   template <class T> Vec3Of<T> torque(const ParametersAndStates<T>& own, const
//   EvaluationContext<T>& now) const;
template <class Derived>
class TorqueLaw : public LawOf<TorqueLaw<Derived>> {
 public:
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.torque_body_N_m += static_cast<const Derived&>(*this).torque(own, now);
  }
};

// For laws that are a force on a platform that slides: Derived has force(), in lab axes, instead of
// torque().
template <class Derived>
class ForceLaw : public LawOf<ForceLaw<Derived>> {
 public:
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.force_lab_N += static_cast<const Derived&>(*this).force(own, now);
  }
};

// A disturbance that acts on the platform: plain data and the law that reads it. Copies share the
// law, but not `parameters`.
struct Disturbance {
  std::string kind;  // set by the reader of the kind
  Stage stage = Stage::torque;
  std::vector<Parameter> parameters;
  std::vector<ExtraState> states;
  std::shared_ptr<const Law> law;
  // The torque may change its sign in a far shorter time than that of the motion. The propagator
  // then also checks the error at the ends of its steps.
  bool is_abrupt = false;
  // Dry friction: about one axis it acts against the direction of slip that the propagator sets,
  // and may stick.
  bool is_dry_friction = false;
  // Delay of commanded torques and forces.
  double command_delay_s = 0.0;
  // The uncertain parameters have different values in every recording, for example a dry torque
  // that changes from day to day.
  bool per_recording = false;
};

// Parameters from settings, in SI, with their sigma. If the key is missing: its default with sigma
// 0 where it has one, else InputError.
using Parameters = std::vector<Parameter>;
// Parameters and the position that their law expects, which make_disturbance() checks.
struct PlacedParameters {
  int first = 0;
  Parameters parameters;
};
// `size` numbers, e.g. the six of a symmetric matrix.
PlacedParameters array_parameter(const Settings& settings, const std::string& key, size_t size,
                                 int first = 0);
// The numbers of a key of any size.
template <int size>
PlacedParameters parameters_of(const Settings& settings, const KeyOf<size>& key) {
  if constexpr (size == 1) {
    const bool is_default = key.otherwise_SI && !settings.has(key.name);
    const Uncertain x =
        is_default ? Uncertain{*key.otherwise_SI} : settings.uncertain(key.name, key.range);
    return {key.first, {{key.name, -1, x.value, x.sigma}}};
  } else if constexpr (size == 3) {
    const UncertainVec3 v = settings.uncertain_vector(key.name);
    PlacedParameters all{key.first, {}};
    for (int i = 0; i < 3; ++i) all.parameters.push_back({key.name, i, v.value[i], v.sigma[i]});
    return all;
  } else {
    return array_parameter(settings, key.name, size, key.first);
  }
}
// Three numbers that are not all zero. InputError for a zero vector.
PlacedParameters direction_parameter(const Settings& settings, const VectorKey& key);
// Number of values that the user wrote for `key`: 0 for a single number, the length of an array,
// nine for three rows of three. In { value = …, sigma = … } it counts those of `value`.
size_t count_as_written(const Settings& settings, std::string_view key);
// The file that `key` names. A relative path is relative to the folder of the experiment file.
std::filesystem::path file_of(const Settings& settings, std::string_view key);
// Parameters that were computed, for example a compliance from the dimensions of a beam.
PlacedParameters fixed_parameter(const std::string& key, std::span<const double> values_SI,
                                 int first = 0);

// The values of three parameters from index `first` on.
Vec3 vector_at(const Parameters& parameters, size_t first);

// Appends `group` to `parameters`. NumericalError if the law expects the group at another position.
void append(Parameters& parameters, const PlacedParameters& group);

// A disturbance with the parameters of all groups in order, and a law built from `law_arguments`.
template <class LawType, class... Arguments>
Disturbance make_disturbance(std::initializer_list<PlacedParameters> groups,
                             Stage stage = Stage::torque, std::vector<ExtraState> states = {},
                             Arguments&&... law_arguments) {
  Disturbance d;
  d.stage = stage;
  for (const PlacedParameters& group : groups) append(d.parameters, group);
  d.states = std::move(states);
  d.law = std::make_shared<const LawType>(std::forward<Arguments>(law_arguments)...);
  return d;
}

// 1 in the lanes at or after `start_s`, 0 before: for laws that start with a jump. `start_s` must
// be one of the law's switches; the propagator adds the derivative with respect to it.
template <class T>
T active_from(const T& time_s, double start_s) {
  return where_at_least(time_s, start_s, T(1.0), T(0.0));
}

// The body axis along which a state relative to the inertial frame takes up the initial rate, if
// the platform starts as one rigid body. It is the present value of the parameter `axis` of the
// disturbance or, without one, ExtraState::per_body_rate. Zero: the state starts at
// ExtraState::initial.
Vec3 bound_axis(const Disturbance& disturbance, const ExtraState& state);
// The initial value of a state of a platform that starts at this rate and angle about its only
// axis.
double initial_value(const Disturbance& disturbance, const ExtraState& state,
                     const Vec3& rate_body_rad_s, double turned_rad);

// Derivative of (bound_axis · rate) with respect to a parameter of the disturbance [(rad/s) per the
// parameter's SI unit].
double bound_rate_slope(const Disturbance& disturbance, const ExtraState& state, int parameter,
                        const Vec3& rate_body_rad_s);

}  // namespace photorque
