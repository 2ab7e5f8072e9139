#include "attitude/disturbances/air/external_air.h"

#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

namespace part_key {
constexpr NumberKey radius("radius_m", Range::positive(), "radius of the disc");
constexpr NumberKey length("length_m", Range::positive(), "length along the flow");
constexpr NumberKey area("area_m2", Range::positive(), "area of one face");
constexpr NumberKey distance("distance_m", Range::not_negative(),
                             "distance of its centre from the axis");
constexpr NumberKey inner("inner_m", 0.0, Range::not_negative(),
                          "distance of its inner end from the axis");
constexpr NumberKey outer("outer_m", Range::positive(),
                          "distance of its outer end from the axis, above `inner_m`",
                          {.varies = true});
constexpr IntegerKey faces("faces", 2, 1, 2, "number of faces in the air");
constexpr NumberKey drag("drag_coefficient", {0.0, 1e3, false, false},
                         "drag coefficient, referred to the area across the flow");
constexpr NumberKey moment("moment_coefficient", sphere_moment_howarth, {0.0, 1e3, true, false},
                           "moment coefficient of the sphere (Howarth); 3.27 is also published");
constexpr ChoiceKey shape("shape",
                          {{"disc", "friction: disc that spins in its plane"},
                           {"plate", "friction: plate that moves edgewise"},
                           {"swept_plate", "friction: plate as a radial strip"},
                           {"sphere", "friction: sphere about its centre"},
                           {"radial_cylinder", "form drag: cylinder whose axis points outwards"},
                           {"upright_cylinder", "form drag: cylinder whose axis is vertical"},
                           {"blunt_face", "form drag: flat face, such as a stiffener or a box"}},
                          "shape of the part; `air_friction` uses only shapes with friction, "
                          "`air_pressure_drag` only those with form drag");
constexpr TextKey name("name", "name of the part", {.usually = "the shape"});
constexpr NumberKey count("count", 1.0, Range::not_negative(),
                          "number of such parts, also fractional");
constexpr TablesKey part("part", "parts in the air of `[environment]`");
}  // namespace part_key

// Von Kármán's disc: the slope G'(0) = −0.6159 of the similarity solution at the wall (White,
// Viscous Fluid Flow, 3rd ed., table 3-5). The torque on one face is ½ π 0.6159 ρ R⁴ √(ν ω³).
constexpr double disc_wall_slope = 0.6159;
// Mean friction coefficient of a plate of length l, one side: 1.328/√Re_l (Blasius).
constexpr double blasius_mean = 1.328;

// Reynolds numbers of transition: disc R²ω/ν (Kobayashi, Kohama, Takamadate 1980), plate v l/ν
// (Schlichting), sphere R²ω/ν (Kohama and Kobayashi 1983, start of turbulence), cylinder v d/ν
// (drag crisis).
constexpr double disc_transition = 2.8e5, plate_transition = 5e5, sphere_transition = 1.5e5,
                 cylinder_transition = 2e5;
// A boundary layer has the thickness 5 l/√Re: a fifth of the length at Re = 600, half at 100.
constexpr double smallest_for_layer = 100.0;
// Drag coefficients of order one need a separated wake.
constexpr double smallest_for_wake = 100.0;

double power4(double x) {
  return x * x * x * x;
}

}  // namespace

AirCoefficients& AirCoefficients::operator+=(const AirCoefficients& other) {
  friction_N_m_s1_5 += other.friction_N_m_s1_5;
  form_N_m_s2 += other.form_N_m_s2;
  return *this;
}

double AirCoefficients::torque_N_m(double rate_rad_s) const {
  return friction_N_m_s1_5 * std::pow(rate_rad_s, 1.5) + form_N_m_s2 * rate_rad_s * rate_rad_s;
}

AirCoefficients air_coefficients(const AirPart& part, const Air& air) {
  // ρ √ν as √(ρ μ), which is zero without air.
  const double rho = air.density_kg_m3, rho_root_nu = std::sqrt(rho * air.viscosity_Pa_s);
  const auto friction = [&](double x) { return AirCoefficients{part.count * x, 0.0}; };
  const auto form = [&](double x) { return AirCoefficients{0.0, part.count * x}; };
  switch (part.shape) {
    case AirShape::disc:
      return friction(0.5 * part.faces * disc_wall_slope * pi * rho_root_nu *
                      power4(part.radius_m));
    case AirShape::plate:  // ½ ρ v² A c_f d with v = ω d
      return friction(0.5 * part.faces * blasius_mean * rho_root_nu / std::sqrt(part.length_m) *
                      part.area_m2 * std::pow(part.distance_m, 2.5));
    case AirShape::swept_plate:
      return friction(0.5 * part.faces * blasius_mean * rho_root_nu * std::sqrt(part.length_m) *
                      (std::pow(part.outer_m, 3.5) - std::pow(part.inner_m, 3.5)) / 3.5);
    case AirShape::sphere:
      return friction(part.moment_coefficient * rho_root_nu * power4(part.radius_m));
    case AirShape::radial_cylinder:
      return form(0.25 * part.drag_coefficient * rho * part.radius_m *
                  (power4(part.inner_m + part.length_m) - power4(part.inner_m)));
    case AirShape::upright_cylinder:
      return form(part.drag_coefficient * rho * part.radius_m * part.length_m *
                  std::pow(part.distance_m, 3));
    case AirShape::blunt_face:
      return form(0.5 * part.drag_coefficient * rho * part.area_m2 * std::pow(part.distance_m, 3));
  }
  return {};
}

AirCoefficients air_coefficients(const std::vector<AirPart>& parts, const Air& air) {
  AirCoefficients sum;
  for (const AirPart& part : parts) sum += air_coefficients(part, air);
  return sum;
}

double disc_torque_as_published(const AirPart& disc, const Air& air, double rate_rad_s) {
  return disc.count * 1.94 * power4(disc.radius_m) * air.density_kg_m3 *
         std::sqrt(air.viscosity_Pa_s * std::pow(rate_rad_s, 3));
}

AirFlow air_flow(const AirPart& part, const Air& air, double rate_rad_s) {
  const double per_m2 = rate_rad_s / air.kinematic_viscosity_m2_s();
  const double outermost_m = part.shape == AirShape::radial_cylinder
                                 ? part.inner_m + part.length_m
                                 : std::max(part.distance_m, part.outer_m);
  switch (part.shape) {
    case AirShape::disc:
      return {per_m2 * part.radius_m * part.radius_m, disc_transition, smallest_for_layer};
    case AirShape::sphere:
      return {per_m2 * part.radius_m * part.radius_m, sphere_transition, smallest_for_layer};
    case AirShape::plate:
    case AirShape::swept_plate:
      return {per_m2 * outermost_m * part.length_m, plate_transition, smallest_for_layer};
    case AirShape::radial_cylinder:
    case AirShape::upright_cylinder:
      return {per_m2 * outermost_m * 2.0 * part.radius_m, cylinder_transition, smallest_for_wake};
    case AirShape::blunt_face:  // sharp edges determine the separation: no drag crisis
      return {per_m2 * outermost_m * std::sqrt(part.area_m2), 1e9, smallest_for_wake};
  }
  return {};
}

std::vector<AirPart> read_air_parts(const std::vector<Settings>& parts) {
  std::vector<AirPart> all;
  for (const Settings& s : parts) {
    AirPart part;
    part.shape = static_cast<AirShape>(s.get(part_key::shape));
    part.name = s.get_or(part_key::name, s.text(part_key::shape));
    part.count = s.get(part_key::count);
    const auto is = [&](auto... shapes) { return ((part.shape == shapes) || ...); };
    using enum AirShape;
    if (is(disc, plate, swept_plate)) part.faces = static_cast<int>(s.get(part_key::faces));
    if (is(disc, sphere, radial_cylinder, upright_cylinder)) {
      part.radius_m = s.get(part_key::radius);
    }
    if (is(plate, swept_plate, radial_cylinder, upright_cylinder)) {
      part.length_m = s.get(part_key::length);
    }
    if (is(plate, blunt_face)) part.area_m2 = s.get(part_key::area);
    if (is(plate, upright_cylinder, blunt_face)) {
      part.distance_m = s.get(part_key::distance);
    }
    if (is(swept_plate, radial_cylinder)) {
      part.inner_m = s.get(part_key::inner);
    }
    if (is(swept_plate))
      part.outer_m = s.get(part_key::outer.within({part.inner_m, 1e308, true, false}));
    if (is(radial_cylinder, upright_cylinder, blunt_face)) {
      part.drag_coefficient = s.get(part_key::drag);
    }
    if (is(sphere)) {
      part.moment_coefficient = s.get(part_key::moment);
    }
    all.push_back(part);
  }
  return all;
}

Table air_table(const std::vector<AirPart>& parts, const Air& air, double rate_rad_s) {
  Table table = Table::of("external_air", "External air by part");
  const double whole_N_m = air_coefficients(parts, air).torque_N_m(rate_rad_s);
  for (const AirPart& part : parts) {
    const AirFlow flow = air_flow(part, air, rate_rad_s);
    const double torque_N_m = air_coefficients(part, air).torque_N_m(rate_rad_s);
    const char* const law_holds = flow.laminar_law_holds()                   ? "yes"
                                  : flow.reynolds > flow.transition_reynolds ? "no: turbulent"
                                                                             : "no: creeping";
    table.row()
        .set("part", part.name)
        .set("law_holds", law_holds)
        .set("torque_N_m", torque_N_m)
        .set("share", whole_N_m > 0.0 ? torque_N_m / whole_N_m : 0.0)
        .set("reynolds", flow.reynolds)
        .set("transition_reynolds", flow.transition_reynolds);
  }
  return table;
}

Key air_parts_key() {
  using namespace part_key;
  return part.of(
      {shape.bringing({{radius, faces},
                       {part_key::length, area, distance, faces},
                       {part_key::length, inner, outer, faces},
                       {radius.meaning("radius of the sphere"), moment},
                       {radius.meaning("radius of the cylinder"),
                        part_key::length.meaning("length of the cylinder"), inner, drag},
                       {radius.meaning("radius of the cylinder"),
                        part_key::length.meaning("length of the cylinder"), distance, drag},
                       {area.meaning("area across the flow"), distance, drag}}),
       name, count});
}

PlacedParameters coefficient_of_air(const Settings& settings, const Environment& environment,
                                    const ScalarKey& key, double AirCoefficients::*of) {
  if (!settings.has("part")) return parameters_of(settings, key);
  const Air air{environment.air_density_kg_m3, environment.air_viscosity_Pa_s};
  const double sum = air_coefficients(read_air_parts(settings.tables("part")), air).*of;
  return fixed_parameter(key.name, {&sum, 1});
}

}  // namespace photorque
