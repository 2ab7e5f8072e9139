// The inertia about the centre of rotation is I + δ, an inertia tensor, instead of the nominal I.
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::inertia_error {
namespace {

constexpr KeyOf<6> delta(
    "delta_kg_m2",
    "[xx, yy, zz, xy, xz, yz], about the centre of rotation; the sum must be an inertia tensor");

struct InertiaError final : LawOf<InertiaError> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.change_inertia(own[delta]);
  }
};

Mat3 as_matrix(const Parameters& d) {
  Mat3 m;
  m << d[0].value, d[3].value, d[4].value,  //
      d[3].value, d[1].value, d[5].value,   //
      d[4].value, d[5].value, d[2].value;
  return m;
}

Mat3 inertia_change_kg_m2(const Disturbance& error) {
  return as_matrix(error.parameters);
}

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  const PlacedParameters six = parameters_of(settings, delta);
  const Mat3 delta_kg_m2 = as_matrix(six.parameters);
  // The reader of [platform] has checked I without δ.
  if (!delta_kg_m2.isZero()) {
    check_inertia(context.platform.inertia_kg_m2 + delta_kg_m2, settings.raw(delta).where,
                  settings.name() + "." + delta.name + " with the platform's inertia");
  }
  return make_disturbance<InertiaError>({six}, Stage::conditions);
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "inertia_error",
          .summary = "the moments or products of inertia differ from those stated",
          .read = read,
          .screening =
              {.parametrisations = {{"the moments or products of inertia differ from those stated",
                                     {{.key = delta.name,
                                       .start = {0, 0, 0, 0, 0, 0},
                                       .scale = 0.03,
                                       .times_inertia = true}}}},
               .inertia_change_kg_m2 = inertia_change_kg_m2},
          .keys = {delta}};
}

}  // namespace photorque::kinds::inertia_error
