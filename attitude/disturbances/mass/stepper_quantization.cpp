// Stepper motors place the balancing masses (moving_masses.h) at whole steps only. Each mass is
// therefore displaced from its target by up to half a step, which displaces the centre of mass of
// the platform. By default the deviations are the worst case of eq. 1: half a step for the first
// mass along each direction and none for masses parallel to it.
#include "attitude/disturbances/kind.h"
#include "attitude/disturbances/mass/moving_masses.h"

namespace photorque::kinds::stepper_quantization {
namespace {

// Deviation of each mass from its target, in steps: one number per mass.
constexpr ScalarKey rounding("rounding_steps");

class StepperQuantization final : public LawOf<StepperQuantization> {
 public:
  explicit StepperQuantization(std::vector<Vec3> com_step_m) : com_step_m_(std::move(com_step_m)) {}

  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    Vec3Of<T> offset_m = Vec3Of<T>::Constant(T(0.0));
    for (size_t i = 0; i < com_step_m_.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        offset_m[k] += com_step_m_[i][k] * own.element(rounding, static_cast<int>(i));
      }
    }
    now.move_mass(offset_m);
  }

 private:
  std::vector<Vec3> com_step_m_;
};

PlacedParameters worst_rounding(const std::vector<MovingMass>& masses) {
  std::vector<double> steps(masses.size(), 0.0);
  for (size_t i = 0; i < masses.size(); ++i) {
    bool parallel_to_earlier = false;
    for (size_t j = 0; j < i; ++j) {
      const double cosine = masses[i].direction_body.dot(masses[j].direction_body);
      parallel_to_earlier = parallel_to_earlier || std::abs(cosine) > 1.0 - 1e-9;
    }
    if (!parallel_to_earlier) steps[i] = 0.5;
  }
  return fixed_parameter(rounding.name, steps);
}

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  const std::vector<MovingMass> masses = read_moving_masses(settings);
  const PlacedParameters steps = settings.has(rounding.name)
                                     ? array_parameter(settings, rounding.name, masses.size())
                                     : worst_rounding(masses);
  std::vector<Vec3> com_step_m;
  for (size_t i = 0; i < masses.size(); ++i) {
    if (std::abs(steps.parameters[i].value) > 0.5) {
      throw settings.error(rounding.name, std::to_string(steps.parameters[i].value),
                           "numbers in [-0.5, 0.5]");
    }
    com_step_m.push_back(masses[i].com_step_m(context.platform.mass_kg));
  }
  return make_disturbance<StepperQuantization>({steps}, Stage::mass, {}, com_step_m);
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "stepper_quantization",
          .summary = "balancing masses stop at whole steps of their motors",
          .read = read,
          .screening = {.reason_against = "found as static_unbalance, which has the same effect"},
          .budget = {.paper_figure = "stepper_torque_N_m"},
          .keys = joined(
              {moving_mass_keys(),
               {NumbersKey(
                   "rounding_steps", {}, "deviation of each mass from its target, in steps, ±0.5",
                   {.usually = "½ for the first along each direction, else 0: the worst case",
                    .has_error = true})}})};
}

}  // namespace photorque::kinds::stepper_quantization
