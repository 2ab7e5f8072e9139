// Euler's equations of the platform under all its disturbances.
//
//   q' = ½ q ⊗ (0, ω)
//   (I − I_d) ω' = T − ω × (I − I_d) ω
//   Q' = battery current
//
// and the equations of the disturbances' extra states. I_d is the inertia with separate springs or
// bearings (EvaluationContext::detach_inertia). A platform with one axis a has ω' = a (a·T) / (a·I
// a) instead. A platform that slides also has m v' = F. The lab is treated as inertial;
// earth_rotation is a disturbance.
#pragma once

#include <vector>

#include "attitude/model/disturbance.h"
#include "attitude/model/platform.h"
#include "attitude/model/schedule.h"

namespace photorque {

// The nominal model: a platform, its surroundings, the disturbances and the commands.
struct AttitudeModel {
  Platform platform;
  Environment environment;
  std::vector<Disturbance> disturbances;
  Schedule schedule;
  // The attitude stays constant. For models in which the attitude is not observed and has no
  // effect: a run of thousands of turns then needs only the steps that its rate requires.
  bool holds_attitude = false;
};

// Sum of the delays of commands of all disturbances, for Schedule::command_delay_s.
double command_delay_s(std::span<const Disturbance> disturbances);

// Layout of the state as the flat vector that is integrated: w, x, y, z, ω, charge, extra states.
namespace component {
inline constexpr int attitude = 0, rate = 4, charge = 7, extra = 8;
}

// The state as a vector in this layout.
std::vector<double> to_vector(const PlatformState& state);
// The state of such a vector, with a normalised quaternion.
PlatformState to_state(double time_s, std::span<const double> y);
// The components in one lane of such vectors.
std::vector<double> lane_of(std::span<const Lanes> y, int lane);

// The additional states of a platform that slides: position and velocity in the lab's xy plane, as
// the extra states of a disturbance without a torque. The model of such a platform must contain it.
inline constexpr const char* translation_kind = "translation";
Disturbance translation();

// A copy of a model, laid out for evaluation. Const and usable from many threads.
class Dynamics {
 public:
  // NumericalError when the inertia is singular.
  explicit Dynamics(AttitudeModel model);

  const AttitudeModel& model() const { return model_; }
  // Components of the state: 8 and the extra states.
  int size() const { return size_; }
  // Deviations of the components that are equally important (1 rad, 1 rad/s, 1 C,
  // ExtraState::scale).
  const std::vector<double>& scales() const { return scales_; }
  // Index of the first extra state of disturbance d in the state vector.
  int first_state(size_t d) const { return layout_[d].first_state; }
  // Index of the first parameter of disturbance d in the list of all parameters.
  int first_parameter(size_t d) const { return layout_[d].first_parameter; }

  // Index of position (x, y) and velocity in the state vector; −1 if the platform does not slide.
  int first_of_translation() const { return translation_; }

  // State at zero attitude that turns at this rate as one rigid body, with the extra states at
  // their initial values for the angle `turned_rad` about the only axis.
  PlatformState initial_state(const Vec3& rate_body_rad_s = Vec3::Zero(),
                              double turned_rad = 0.0) const;

  // dy/dt at eight instants; `y` and `rates` hold size() components.
  void rates(const Lanes& time_s, const ZeroOrderHold& held, const Lanes* y, Lanes* rates) const;

  // The variables of one differentiation, at most DualLanes::block: component `state[k]` of the
  // state or parameter `parameter[k]`. −1: unused.
  struct Block {
    std::array<int, DualLanes::block> state;
    std::array<int, DualLanes::block> parameter;

    Block() {
      state.fill(-1);
      parameter.fill(-1);
    }
  };
  // Memory for an evaluation with derivatives. Frequent callers reuse it.
  struct Workspace {
    std::vector<DualLanes> y, parameters, rates;
    std::vector<size_t> acting, owners;
  };
  // ∂(dy/dt)/∂(variable k) of every component c at derivatives[c·block + k].
  void derivatives(const Lanes& time_s, const ZeroOrderHold& held, const Lanes* y,
                   const Block& block, Lanes* derivatives, Workspace& room) const;

  // All quantities at eight instants. `held`, the commands of each instant, may differ from lane to
  // lane.
  struct Instants {
    std::vector<Vec3Of<Lanes>> torque_body_N_m;  // of each disturbance, in the model's order
    std::vector<Vec3Of<Lanes>> force_lab_N;      // of each disturbance, in the model's order
    Vec3Of<Lanes> command_body_N_m;              // the torque that acts
    Vec3Of<Lanes> command_lab_N;                 // the force that acts
    Vec3Of<Lanes> mass_offset_body_m;
    Lanes battery_current_A;
    Lanes array_power_W;
    Lanes illumination;
    Lanes gravity_gradient_1_s2;  // see EvaluationContext
    Vec3Of<Lanes> inertial_rate_body_rad_s;
    // Readings of noiseless instruments; see EvaluationContext.
    Vec3Of<Lanes> gyro_rad_s;
    Vec3Of<Lanes> camera_error_rad;
    Lanes camera_delay_s;
    std::vector<Lanes> rates;  // dy/dt
  };
  Instants at(const Lanes& time_s, const std::array<ZeroOrderHold, Lanes::count>& held,
              const Lanes* y) const;
  // Evaluates them at one state, in all lanes, with the commands of the model's schedule.
  Instants at(const PlatformState& state) const;

  // Differences of noiseless readings from the platform's rate and attitude. They exist only if
  // they do not depend on the motion.
  struct Offsets {
    Vec3 gyro_rad_s, camera_rad;
    double camera_delay_s = 0.0;
    bool operator==(const Offsets&) const = default;
  };
  const std::optional<Offsets>& offsets() const { return offsets_; }

  // Derivatives of the instruments' readings with respect to the variables of `block`: gyro [0, 3),
  // camera error [3, 6), camera delay [6]; each is a row of `block` numbers.
  static constexpr int reading_count = 7;
  void reading_derivatives(const Lanes& time_s, const std::array<ZeroOrderHold, Lanes::count>& held,
                           const Lanes* y, const Block& block, Lanes* derivatives,
                           Workspace& room) const;

 private:
  struct Layout {
    int first_state = 0;
    int first_parameter = 0;
  };
  // ZeroOrderHold values as lanes.
  struct Command {
    Vec3Of<Lanes> torque_body_N_m, force_lab_N, force_body_N;
    Lanes battery_current_A;
    Lanes led_current_A, lamps_as_stated;
    Vec3Of<Lanes> light_body_N_m;
    Vec3Of<Lanes> wheel_rad_s, wheel_rad_s2;
    Lanes slip_is_held, slip_sign;
  };
  static Command broadcast(const ZeroOrderHold& held, const Lanes& time_s);
  static Command gather(const std::array<ZeroOrderHold, Lanes::count>& held, const Lanes& time_s);

  template <class T>
  EvaluationContext<T> begin(const T& time_s, const Command& command, const T* y) const;
  template <class T, class Act>
  void run_stages(const std::vector<size_t>& order, EvaluationContext<T>& now,
                  const Act& act) const;
  template <class T>
  void put_attitude_rates(const T* y, T* rates) const;
  template <class T>
  Vec3Of<T> about_axis(const Vec3Of<T>& torque_N_m, const Mat3Of<T>& inertia_kg_m2) const;
  template <class T>
  void solve(const EvaluationContext<T>& now, const T* y, T* rates) const;
  void apply_law(size_t d, const std::vector<Lanes>& parameters, const Lanes* y, Lanes* rates,
                 EvaluationContext<Lanes>& now) const;
  void try_laws();
  Offsets tried(const PlatformState& state, const std::vector<Lanes>& instruments);
  void free_body_rates(const Command& command, const Lanes* y, Lanes* rates) const;
  // Evaluates with derivatives, leaving out disturbances that cannot depend on the block.
  EvaluationContext<DualLanes> differentiate(const Lanes& time_s, const Command& command,
                                             const Lanes* y, const Block& block,
                                             bool with_instruments, Workspace& room) const;

  AttitudeModel model_;
  int size_ = component::extra;
  std::vector<double> scales_;
  std::vector<Layout> layout_;
  int translation_ = -1;
  std::vector<size_t> order_;        // disturbances by stage, without those of Stage::measurement
  std::vector<size_t> instruments_;  // disturbances of Stage::measurement
  std::vector<Lanes> parameters_;
  Mat3 inverse_inertia_1_kg_m2_;
  std::vector<bool> changes_inertia_;  // of each disturbance
  std::optional<Offsets> offsets_;
};

// Whether the motion depends on the attitude, for example by gravity, a magnetic field or a draught
// of the lab. For a platform with one axis: on the rotation about that axis.
bool depends_on_attitude(const AttitudeModel& model);

// The torque of every disturbance at one state [N m], in the model's order, body axes.
std::vector<Vec3> disturbance_torques_body_N_m(const AttitudeModel& model,
                                               const PlatformState& state);
// The force of every disturbance on a platform that slides [N], lab axes.
std::vector<Vec3> disturbance_forces_lab_N(const AttitudeModel& model, const PlatformState& state);

}  // namespace photorque
