// The structure bends under its own weight: T = m C (g_B − g_ref) × g_B, g_ref the gravity at zero
// attitude, where the platform was balanced (eq. 2–3, corrected and made general).
//
// compliance_s2: displacement of the centre of mass per unit of gravity, body axes; three numbers
// (its diagonal) or a symmetric 3 × 3 matrix; or the table dumbbell = {length_m, end_mass_kg,
// beam_mass_kg, bending_stiffness_N_m2, axis (default x)}, or tabletop = {length_m, total_mass_kg,
// bending_stiffness_N_m2, count}: see sag_compliance.h.
#include "attitude/disturbances/kind.h"
#include "attitude/disturbances/mass/sag_compliance.h"

namespace photorque::kinds::elastic_sag {
namespace {

constexpr VectorKey diagonal{"compliance_s2"};
constexpr MatrixKey compliance{diagonal.name};

template <class T>
Vec3Of<T> gravity_change(const EvaluationContext<T>& now) {
  return now.gravity_body_m_s2 - now.gravity_lab_m_s2;  // at zero attitude both axes agree
}

struct DiagonalSag final : LawOf<DiagonalSag> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.move_mass(own[diagonal].cwiseProduct(gravity_change(now)));
  }
};

struct MatrixSag final : LawOf<MatrixSag> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.move_mass(own[compliance] * gravity_change(now));
  }
};

Mat3 read_compliance_s2(const Settings& settings, double platform_mass_kg) {
  if (settings.has("dumbbell")) {
    const Settings s = settings.table("dumbbell");
    const DumbbellArms arms{s.vector3_or("axis", Vec3::UnitX()),
                            s.number("length_m", Range::positive()),
                            s.number("end_mass_kg", Range::not_negative()),
                            s.number("beam_mass_kg", Range::not_negative()),
                            s.number("bending_stiffness_N_m2", Range::positive())};
    if (!(arms.axis_body.norm() > 0.0)) throw s.error("axis", "a zero vector", "a direction");
    return sag_compliance_s2(arms, platform_mass_kg);
  }
  if (settings.has("tabletop")) {
    const Settings s = settings.table("tabletop");
    return sag_compliance_s2(
        CounterbalanceBeams{s.number("length_m", Range::positive()),
                            s.number("total_mass_kg", Range::not_negative()),
                            s.number("bending_stiffness_N_m2", Range::positive()),
                            static_cast<int>(s.integer("count", 1, 1000))},
        platform_mass_kg);
  }
  Mat3 compliance_s2 = settings.matrix3(compliance.name);
  if ((compliance_s2 - compliance_s2.transpose()).norm() > 1e-9 * compliance_s2.norm()) {
    throw settings.error(compliance.name, "a matrix that is not symmetric", "a symmetric matrix");
  }
  return compliance_s2;
}

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  const bool computed = settings.has("dumbbell") || settings.has("tabletop");
  if (!computed && count_as_written(settings, diagonal.name) == 3) {
    return make_disturbance<DiagonalSag>({vector_parameter(settings, diagonal)}, Stage::mass);
  }
  const Mat3 compliance_s2 = read_compliance_s2(settings, context.platform.mass_kg);
  return make_disturbance<MatrixSag>({fixed_parameter(compliance.name, {compliance_s2.data(), 9})},
                                     Stage::mass);
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "elastic_sag",
      .summary = "the structure bends differently at every tilt",
      .read = read,
      .screening =
          {.parametrisations = {{"the structure bends under its weight, differently at every tilt",
                                 {EffectKey::vector_not_negative(diagonal.name, 5e-7)}}},
           .needs = Requirement::gravity},
      .keys = {Key::other("compliance_s2", Key::an_array | Key::a_table,
                          "C in T = m C (g − g at zero tilt) × g, metres per m/s²: three numbers "
                          "(a diagonal; only these take ±) or a symmetric 3 × 3 matrix; *or*")
                   .optional(),
               Key::table("dumbbell",
                          {Key::vector3_or("axis", Vec3::UnitX(), "of the arms, body axes"),
                           Key::number("length_m", Range::positive(), "of one arm"),
                           Key::number("end_mass_kg", Range::not_negative(), "at its end"),
                           Key::number("beam_mass_kg", Range::not_negative(), "of one arm"),
                           Key::number("bending_stiffness_N_m2", Range::positive(), "EI")},
                          "two arms, from which C follows; *or*"),
               Key::table("tabletop",
                          {Key::number("length_m", Range::positive(), "of a beam"),
                           Key::number("total_mass_kg", Range::not_negative(), "of all"),
                           Key::number("bending_stiffness_N_m2", Range::positive(), "EI of one"),
                           Key::integer("count", 1, 1000, "of beams")},
                          "beams along z, from which C follows")}};
}

}  // namespace photorque::kinds::elastic_sag
