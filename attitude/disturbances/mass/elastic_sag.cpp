// The structure bends under its weight: T = m C (g_B − g_ref) × g_B, where g_ref is the gravity at
// zero attitude, at which the platform was balanced (eq. 2–3, corrected and generalised). The
// symmetric compliance C [s²] is the displacement of the centre of mass per unit of gravity, body
// axes. It is computed for the two structures of the paper: dumbbells and tabletops. Their beams
// are slender, clamped at the middle, and bend only across their length (Euler–Bernoulli,
// docs/physics.md).
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::elastic_sag {
namespace {

constexpr VectorKey diagonal("compliance_s2");
constexpr MatrixKey compliance{diagonal.name};

namespace key {
constexpr OtherKey compliance(
    "compliance_s2", Key::an_array | Key::a_table,
    "C in T = m C (g − g at zero tilt) × g, metres per m/s²: three numbers (a diagonal; "
    "only these take ±) or a symmetric 3 × 3 matrix; *or*",
    {.optional = true});
constexpr Vec3Key axis("axis", {1.0, 0.0, 0.0}, "direction of the arms, body axes, any length");
constexpr NumberKey length("length_m", Range::positive(),
                           "length of one arm, from the middle to the end");
constexpr NumberKey end_mass("end_mass_kg", Range::not_negative(), "mass at the end of an arm");
constexpr NumberKey beam_mass("beam_mass_kg", Range::not_negative(), "mass of the beam of one arm");
constexpr NumberKey bending_stiffness("bending_stiffness_N_m2", Range::positive(),
                                      "bending stiffness EI of an arm");
constexpr TableKey dumbbell("dumbbell", "two arms, from which C follows; *or*");
constexpr NumberKey tabletop_length("length_m", Range::positive(), "length of a beam");
constexpr NumberKey total_mass("total_mass_kg", Range::not_negative(), "mass of all beams");
constexpr NumberKey tabletop_bending_stiffness("bending_stiffness_N_m2", Range::positive(),
                                               "bending stiffness EI of one beam");
constexpr IntegerKey count("count", 1, 1000, "number of beams");
constexpr TableKey tabletop("tabletop", "beams along z, from which C follows");
}  // namespace key

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

// ∫ (displacement) dm [kg s²] of one clamped beam of mass m with an end mass M, per unit of
// transverse gravity. Per unit load, the end load displaces the end by l³/3EI and the mean of the
// beam by l³/8EI. The weight of the beam displaces the end by l³/8EI and its mean by l³/20EI.
struct Beam {
  double length_m, end_mass_kg, mass_kg, bending_stiffness_N_m2;
};
double sagging_moment_kg_s2(const Beam& beam) {
  const double l = beam.length_m, M = beam.end_mass_kg, m = beam.mass_kg;
  return l * l * l * (M * M / 3.0 + M * m / 4.0 + m * m / 20.0) / beam.bending_stiffness_N_m2;
}

Mat3 across(const Vec3& axis) {
  const Vec3 a = axis.normalized();
  return Mat3::Identity() - a * a.transpose();
}

Mat3 read_compliance_s2(const Settings& settings, double platform_mass_kg) {
  if (settings.has(key::dumbbell)) {
    const Settings s = settings.get(key::dumbbell);
    return 2.0 *
           sagging_moment_kg_s2({s.get(key::length), s.get(key::end_mass), s.get(key::beam_mass),
                                 s.get(key::bending_stiffness)}) /
           platform_mass_kg * across(direction_of(s, key::axis));
  }
  if (settings.has(key::tabletop)) {
    const Settings s = settings.get(key::tabletop);
    const auto count = static_cast<double>(s.get(key::count));
    return count *
           sagging_moment_kg_s2({s.get(key::tabletop_length), 0.0, s.get(key::total_mass) / count,
                                 s.get(key::tabletop_bending_stiffness)}) /
           platform_mass_kg * across(Vec3::UnitZ());
  }
  Mat3 compliance_s2 = settings.matrix3(compliance.name);
  if ((compliance_s2 - compliance_s2.transpose()).norm() > 1e-9 * compliance_s2.norm()) {
    throw settings.error(compliance.name, "a matrix that is not symmetric", "a symmetric matrix");
  }
  return compliance_s2;
}

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  const bool computed = settings.has(key::dumbbell) || settings.has(key::tabletop);
  if (!computed && count_as_written(settings, diagonal.name) == 3) {
    return make_disturbance<DiagonalSag>({parameters_of(settings, diagonal)}, Stage::mass);
  }
  const Mat3 compliance_s2 = read_compliance_s2(settings, context.platform.mass_kg);
  return make_disturbance<MatrixSag>({fixed_parameter(compliance.name, {compliance_s2.data(), 9})},
                                     Stage::mass);
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "elastic_sag",
          .summary = "the structure bends differently at every tilt",
          .read = read,
          .screening = {.parametrisations =
                            {{"the structure bends under its weight, differently at every tilt",
                              {EffectKey::vector_not_negative(diagonal.name, 5e-7)}}},
                        .needs = Requirement::gravity},
          .keys = {key::compliance,
                   key::dumbbell.of({key::axis, key::length, key::end_mass, key::beam_mass,
                                     key::bending_stiffness}),
                   key::tabletop.of({key::tabletop_length, key::total_mass,
                                     key::tabletop_bending_stiffness, key::count})}};
}

}  // namespace photorque::kinds::elastic_sag
