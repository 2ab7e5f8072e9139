// Something slips: the same as static_unbalance, from one instant on.
//
// time_s: the instant. offset_m[3]: what the centre of mass moves by, body axes.
#include <cmath>

#include "attitude/disturbances/kind.h"

namespace photorque::kinds::mass_shift {
namespace {

constexpr ScalarKey start{"time_s"};
constexpr VectorKey offset{"offset_m", start.end()};

struct MassShift final : LawOf<MassShift> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const double start_s = values(own[start])[0];
    now.move_mass(active_from(now.time_s, start_s) * own[offset]);
  }

  std::vector<Switch> switches(std::span<const Parameter> parameters, double from_s,
                               double to_s) const override {
    const double start_s = parameters[start.first].value;
    if (start_s > from_s && start_s < to_s) return {{start_s, start.first}};
    return {};
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  return make_disturbance<MassShift>(
      {scalar_parameter(settings, start), vector_parameter(settings, offset)}, Stage::mass);
}

// The law again, for `prove`.
injected::PlainTorque plain_torque(const InjectedEffect& effect) {
  using namespace injected;
  return [start_s = effect.number(start.name),
          offset_m = effect.triple(offset.name)](const Surroundings& s) {
    return s.time_s >= start_s ? s.weight_at(offset_m) : Triple{};
  };
}

std::vector<double> plain_jumps_s(const InjectedEffect& effect, double, double) {
  return {effect.number(start.name)};
}

injected::EffectNumbers draw_example(injected::RandomDraw& draw,
                                     const injected::ExampleConditions& conditions) {
  const double time_s = draw.uniform(0.25, 0.65) * conditions.duration_s;
  return {{start.name, {std::round(10.0 * time_s) / 10.0}},
          {offset.name, injected::list(injected::times(2e-6, draw.direction()))}};
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "mass_shift",
      .summary = "the centre of mass jumps at one instant",
      .read = read,
      .screening =
          {.parametrisations =
               {{"a part of the platform moved at one instant and took the centre of mass with it",
                 {EffectKey::shape(start.name, 0.0, 100.0, 0.0),
                  EffectKey::vector(offset.name, 3e-6)}}},
           .needs = Requirement::gravity,
           .scan = Scan::instant},
      .injection = {.draw = draw_example,
                    .torque = plain_torque,
                    .jumps_s = plain_jumps_s,
                    .strength = offset.name,
                    .pairs = true},
      .keys = {Key::uncertain("time_s", {}, "when"),
               Key::uncertain_vector("offset_m", "by what the centre of mass moves, body axes")}};
}

}  // namespace photorque::kinds::mass_shift
