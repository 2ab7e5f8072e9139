// The inertia is not the nominal model: I + δ, about the centre of rotation.
//
// delta_kg_m2[6]: xx, yy, zz, xy, xz, yz. The whole must remain an inertia.
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

template <class T>
Mat3Of<T> symmetric(const T& xx, const T& yy, const T& zz, const T& xy, const T& xz, const T& yz) {
  Mat3Of<T> m;
  m << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return m;
}

struct InertiaError final : LawOf<InertiaError> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const T* d = own.parameters;
    now.change_inertia(symmetric<T>(d[0], d[1], d[2], d[3], d[4], d[5]));
  }
};

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  const std::string key = "delta_kg_m2";
  const Parameters d = array_parameter(settings, key, 6);
  const Mat3 delta_kg_m2 =
      symmetric(d[0].value, d[1].value, d[2].value, d[3].value, d[4].value, d[5].value);
  check_inertia(context.platform.inertia_kg_m2 + delta_kg_m2, settings.raw(key).where,
                settings.name() + "." + key + " with the platform's inertia");
  return make_disturbance<InertiaError>({d}, Stage::conditions);
}

}  // namespace

DisturbanceKind inertia_error_kind() {
  return {"inertia_error", "the moments or products of inertia are not those believed", read};
}

}  // namespace photorque
