// Viscous drag of the air film: T = −c ω (eq. 5, 14–17). c is equal about every axis, or has two
// values: about the socket's axis (lab z) and perpendicular to it. The model of the air film that
// gives both, also for a gap that follows from the supply, is air_bearing.h.
#include "attitude/disturbances/bearing/air_bearing.h"
#include "attitude/disturbances/kind.h"

namespace photorque::kinds::bearing_drag {
namespace {

// A sum of coefficients below this value would drive the platform. It is not zero, because a
// nominal coefficient and a fitted change may cancel only up to rounding errors.
constexpr double min_sum_N_m_s = -1e-6;

constexpr auto coefficient =
    ScalarKey("coefficient_N_m_s", Range::not_negative(), "c in T = −c ω, about every axis; *or*")
        .optional();
constexpr auto about_axis =
    ScalarKey("axial_N_m_s", Range::not_negative(), "c about the vertical; with `transverse_N_m_s`")
        .optional();
constexpr auto across_axis = ScalarKey("transverse_N_m_s", Range::not_negative(),
                                       "c about horizontal axes; *or*", about_axis.end())
                                 .optional();

namespace key {
constexpr NumberKey radius("radius_m", Range::positive(), "radius of the ball");
constexpr NumberKey half_angle("half_angle_deg", {0.0, pi, true, false},
                               "polar angle of the socket's rim");
constexpr NumberKey recess_half_angle(
    "recess_half_angle_deg", 0.0, {0.0, pi, false, true},
    "polar angle of the rim of the central recess, below `half_angle_deg`", {.varies = true});
constexpr NumberKey sheared_share("sheared_share", 1.0, Range::fraction(),
                                  "fraction of the film that is thin (reduced by grooves)");
constexpr NumberKey gap(
    "gap_m", Range::positive(),
    "thickness of the film under the platform's weight; with the next two keys, at the rated load",
    {.optional = true});
constexpr NumberKey rated_load("rated_load_N", Range::positive(),
                               "load at which the film has the thickness `gap_m`",
                               {.optional = true});
constexpr NumberKey stiffness("stiffness_N_m", Range::positive(),
                              "stiffness of the film as a linear spring, in newton per metre",
                              {.optional = true});
constexpr NumberKey supply(
    "supply_Pa", Range::positive(),
    "instead of `gap_m`: absolute supply pressure, above the ambient pressure. The gap follows "
    "from it and from the feeding holes; needs a recess",
    {.optional = true, .varies = true});
constexpr NumberKey hole_area("hole_area_mm2", Range::positive(), "total area of the feeding holes",
                              {.optional = true});
constexpr NumberKey discharge_coefficient("discharge_coefficient", 0.8, {0.0, 1.0, true, false},
                                          "discharge coefficient of the feeding holes");
constexpr TableKey socket("socket", "both coefficients, from the geometry of the air film");
}  // namespace key

struct IsotropicDrag final : TorqueLaw<IsotropicDrag> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    return -own[coefficient] * now.rate_body_rad_s;
  }
};

struct SocketDrag final : TorqueLaw<SocketDrag> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const T axial = own[about_axis], transverse = own[across_axis];
    const Vec3Of<T> axis_body = now.lab_from_body.row(2).transpose();
    const T spin = axis_body.dot(now.rate_body_rad_s);
    return -transverse * now.rate_body_rad_s - (axial - transverse) * spin * axis_body;
  }
};

double read_gap_m(const Settings& s, SphericalSocket socket, const DisturbanceContext& context) {
  const double load_N = context.platform.mass_kg * context.environment.gravity_lab_m_s2.norm();
  if (s.has(key::supply)) {
    const FilmAir air{context.environment.air_pressure_Pa, context.environment.air_temperature_K,
                      context.environment.air_viscosity_Pa_s};
    const OrificeFeed feed{s.get(key::supply.within({air.pressure_Pa, 1e308, true, false})),
                           s.get(key::hole_area), s.get(key::discharge_coefficient)};
    if (!(socket.recess_half_angle_rad > 0.0)) {
      throw s.error(key::recess_half_angle, "none", "a recess that the holes feed");
    }
    return gap_under_load_m(socket, feed, air, load_N);
  }
  const double gap_m = s.get(key::gap);
  if (!s.has(key::stiffness)) return gap_m;
  const double loaded_m =
      spring_gap_m(gap_m, s.get(key::rated_load), s.get(key::stiffness), load_N);
  if (!(loaded_m > 0.0)) {
    throw s.error(key::stiffness, "a gap that the platform's weight closes", "a stiffer bearing");
  }
  return loaded_m;
}

FilmDrag read_socket_drag(const Settings& s, const DisturbanceContext& context) {
  SphericalSocket socket;
  socket.radius_m = s.get(key::radius);
  socket.half_angle_rad = s.get(key::half_angle);
  socket.recess_half_angle_rad =
      s.get(key::recess_half_angle.within({0.0, socket.half_angle_rad, false, true}));
  socket.sheared_fraction = s.get(key::sheared_share);
  socket.gap_m = read_gap_m(s, socket, context);
  return film_drag(socket, context.environment.air_viscosity_Pa_s);
}

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  if (settings.has(key::socket)) {
    const FilmDrag drag = read_socket_drag(settings.get(key::socket), context);
    return make_disturbance<SocketDrag>(
        {fixed_parameter(about_axis.name, {&drag.axial_N_m_s, 1}),
         fixed_parameter(across_axis.name, {&drag.transverse_N_m_s, 1}, across_axis.first)});
  }
  if (settings.has(about_axis.name)) {
    return make_disturbance<SocketDrag>(
        {parameters_of(settings, about_axis), parameters_of(settings, across_axis)});
  }
  return make_disturbance<IsotropicDrag>({parameters_of(settings, coefficient)});
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "bearing_drag",
      .summary = "viscous drag of the bearing's air film, linear in the rate",
      .read = read,
      .screening = {.parametrisations = {{"the viscous drag of the bearing differs from the stated "
                                          "one by more than its uncertainty",
                                          {EffectKey::number(coefficient.name, 2e-5)}}},
                    .needs = Requirement::bearing,
                    .minimum_sum =
                        MinimumSum{min_sum_N_m_s, "the bearing's drag would feed energy"}},
      .keys = {coefficient, about_axis, across_axis,
               key::socket.of({key::radius, key::half_angle, key::recess_half_angle,
                               key::sheared_share, key::gap, key::rated_load, key::stiffness,
                               key::supply, key::hole_area, key::discharge_coefficient})}};
}

}  // namespace photorque::kinds::bearing_drag
