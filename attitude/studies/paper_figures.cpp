#include "attitude/studies/paper_figures.h"

#include <cmath>
#include <limits>

#include "attitude/disturbances/bearing/air_bearing.h"
#include "attitude/disturbances/mass/battery.h"
#include "attitude/disturbances/mass/moving_masses.h"
#include "attitude/environment/igrf.h"
#include "attitude/recordings/sensors.h"
#include "core/constants.h"
#include "core/numerics/root.h"
#include "core/text/format.h"

namespace photorque {

namespace {

// Values that the paper states.
constexpr double platform_mass_kg = 7.0;
constexpr double one_rpm_rad_s = 2.0 * pi / 60.0;
constexpr double limit_tilt_rad = 30.0 * degree_rad;
constexpr double battery_charge_C = 2.4 * 3600.0;
constexpr double battery_half_length_m = 0.03225;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr Air room;

std::string number(double x) {
  return printed("%.3g", x);
}

MovingMass moving_mass(const PaperInputs& in) {
  return {Vec3::UnitX(), in.moving_mass_kg, in.screw_lead_m, in.step_angle_rad, 1};
}

double equal_area_radius_m(double side_m) {
  return side_m / std::sqrt(pi);
}

double torque_N_m(const std::vector<AirPart>& parts, double rate_rad_s = one_rpm_rad_s) {
  return air_coefficients(parts, room).torque_N_m(rate_rad_s);
}

double disc_torque_as_published(const std::vector<AirPart>& plates) {
  double sum = 0.0;
  for (const AirPart& plate : plates) {
    sum += disc_torque_as_published(plate, room, one_rpm_rad_s);
  }
  return sum;
}

// Rate [rpm] at which the parts have this torque.
double rate_for_torque_rpm(const std::vector<AirPart>& parts, double wanted_N_m) {
  const auto too_slow = [&](double rate_rad_s) {
    return torque_N_m(parts, rate_rad_s) < wanted_N_m;
  };
  return bisect(0.0, 1e4, too_slow).low / one_rpm_rad_s;
}

// Decimal year at which the dipole of IGRF was as strong as the paper's.
double year_of_dipole(double field_T) {
  const auto stronger = [&](double year) {
    return GeomagneticModel(year).dipole_equatorial_field_T() > field_T;
  };
  return bisect(1900.0, 2025.0, stronger).low;  // the field decreases during the whole interval
}

// The paper's platform as separate bodies: the plates, the rails, the blunt faces.
struct PaperAirParts {
  std::vector<AirPart> plates, rails, faces;

  std::vector<AirPart> all() const {
    std::vector<AirPart> all = plates;
    all.insert(all.end(), rails.begin(), rails.end());
    all.insert(all.end(), faces.begin(), faces.end());
    return all;
  }
};

PaperAirParts paper_air_parts(const PaperInputs& in) {
  const double scale = in.platform_scale;
  const auto disc = [&](const char* name, double side_m) {
    return AirPart{
        .name = name, .shape = AirShape::disc, .radius_m = scale * equal_area_radius_m(side_m)};
  };
  const auto face = [&](const char* name, double width_m, double height_m, double distance_m,
                        double drag_coefficient) {
    return AirPart{.name = name,
                   .shape = AirShape::blunt_face,
                   .count = 4.0,
                   .area_m2 = scale * scale * width_m * height_m,
                   .distance_m = scale * distance_m,
                   .drag_coefficient = drag_coefficient};
  };
  PaperAirParts parts;
  parts.plates = {disc("top plate", in.top_plate_side_m),
                  disc("bottom plate", in.bottom_plate_side_m)};
  parts.rails = {{.name = "vertical rails",
                  .shape = AirShape::upright_cylinder,
                  .count = 4.0,
                  .radius_m = scale * in.rail_radius_m,
                  .length_m = scale * in.rail_length_m,
                  .distance_m = scale * in.rail_distance_m,
                  .drag_coefficient = in.cylinder_drag_coefficient}};
  parts.faces = {face("horizontal masses", 0.045, 0.040, 0.150, in.box_drag_coefficient),
                 face("vertical masses", 0.045, 0.045, 0.193, in.box_drag_coefficient),
                 face("batteries", 0.040, 0.012, 0.105, in.box_drag_coefficient),
                 face("avionics", 0.050, 0.030, 0.148, in.box_drag_coefficient),
                 // Different parts of a rib of 0.2025 m have different speeds. This distance from
                 // the axis gives the third moment of the rib.
                 face("stiffeners", 0.2025, 0.020, 0.0758, in.rib_drag_coefficient)};
  return parts;
}

// The cylinders in the position of eq. 22: horizontal, from the axis outwards.
std::vector<AirPart> cylinders_from_axis(std::vector<AirPart> rails) {
  for (AirPart& rail : rails) {
    rail.shape = AirShape::radial_cylinder;
    rail.inner_m = 0.0;
  }
  return rails;
}

void add_structure(std::vector<PaperFigure>& all, const PaperInputs& in) {
  const MovingMass mass = moving_mass(in);
  const std::string usual =
      "step, lead and mass are not printed; the usual parts assumed here agree";
  all.push_back({"com_resolution_m", "II.A.1", 1.79e-7, com_resolution_m(mass, platform_mass_kg),
                 nan, usual});
  all.push_back(
      {"stepper_torque_N_m", "II.A.1", 1.23e-5,
       horizontal_rounding_torque_N_m(mass, 0.0, standard_gravity_m_s2), nan,
       "printed as \",23e-5\": the lost digit is 1, the weight that of the whole platform"});
}

void add_bearing(std::vector<PaperFigure>& all, const PaperInputs& in) {
  const UnloadedDrag drag = unloaded_drag(in);
  const std::string data =
      "for the one bearing assumed here; the catalogue is not in the paper: give it as "
      "budget.bearing; ";
  all.push_back({"bearing_load_mean_error", "II.B.1", 0.24,
                 std::abs(drag.load_as_published_N / drag.rated_load_N - 1.0), nan,
                 data + "eq. 7 compared with the film at its rated gap: eq. 7 omits projection and "
                        "ambient pressure"});
  all.push_back(
      {"bearing_drag_mean_ratio", "II.B.1", 19.63, drag.ratio_film, nan,
       data + "eq. 17 at the rated gap compared with the unloaded ball of the catalogues: "
              "the gap is larger by this factor; the remainder is due to recess and grooves"});
  all.push_back({"bearing_drag_mean_ratio_with_spring", "II.B.1", 9.0,
                 drag.ratio_film / drag.ratio_spring, nan,
                 data + "remaining ratio if the gap depends on the load like a spring"});
  all.push_back(
      {"bearing_unloaded_gap_ratio", "II.B.1", 19.63 / 9.0, drag.ratio_spring, nan,
       "gap of the unloaded ball over the rated gap in the spring model (paper: 19.63/9); "
       "in the physical model, the gap increases " +
           number(drag.ratio_film) + " times, which leaves " + number(19.63 / drag.ratio_film) +
           " of the 19.63 for recess and grooves"});
}

void add_air(std::vector<PaperFigure>& all, const PaperInputs& in) {
  const PaperAirParts parts = paper_air_parts(in);
  const std::vector<AirPart> everything = parts.all();
  all.push_back({"lumped_drag_at_1_rpm_N_m", "II.B.2", 9.97e-6, torque_N_m(parts.plates),
                 disc_torque_as_published(parts.plates),
                 "plates are not dimensioned; torque goes with the fourth power of their size"});
  all.push_back(
      {"cylinder_drag_at_1_rpm_N_m", "II.B.2", 2.80e-11, torque_N_m(parts.rails),
       torque_N_m(cylinders_from_axis(parts.rails)),
       "eq. 22 is for a cylinder that points away from the axis; upright at their distance "
       "the drag of the rails is larger, and even from the axis outwards (ours_as_published) their "
       "length gives more than printed"});
  all.push_back(
      {"cfd_drag_at_1_rpm_N_m", "II.B.2", 2.63e-4, torque_N_m(everything), nan,
       "plates, rails and blunt faces of the scene; the figure needs c_d A d^3 of " +
           number(2.0 * (2.63e-4 - 2.73e-5) /
                  (room.density_kg_m3 * one_rpm_rad_s * one_rpm_rad_s)) +
           " m^5, the scene has " +
           number(2.0 * air_coefficients(everything, room).form_N_m_s2 / room.density_kg_m3) +
           "; photorque gives this torque at " + number(rate_for_torque_rpm(everything, 2.63e-4)) +
           " rpm"});
  all.push_back({"cfd_friction_at_1_rpm_N_m", "II.B.2", 2.73e-5, torque_N_m(parts.plates), nan,
                 "as the lumped drag; photorque gives this torque at " +
                     number(rate_for_torque_rpm(parts.plates, 2.73e-5)) + " rpm"});
}

void add_fields(std::vector<PaperFigure>& all, const PaperInputs& in) {
  all.push_back({"dipole_equatorial_field_T", "II.C.1", dipole_equatorial_field_T,
                 GeomagneticModel(2025.0).dipole_equatorial_field_T(), nan,
                 "IGRF-14's dipole of 2025; it was the paper's in " +
                     std::to_string(std::lround(year_of_dipole(dipole_equatorial_field_T)))});
  // Black sheet in a wider vertical beam: force P cos θ/c at the distance h sin θ from the centre.
  const double torque_N_m = in.light_on_cells_W * std::cos(limit_tilt_rad) / speed_of_light_m_s *
                            in.array_height_m * std::sin(limit_tilt_rad);
  all.push_back({"radiation_torque_at_30_deg_N_m", "II.C.2", 1.127e-9, torque_N_m,
                 torque_N_m * std::cos(limit_tilt_rad),
                 "black array in a beam wider than itself; traced by the commands power and "
                 "torque-map; eq. 29 takes the cosine twice"});
}

void add_light(std::vector<PaperFigure>& all, const PaperLight& light) {
  const std::string traced = "traced by the command power, which says why; given as budget.light";
  all.push_back({"source_to_cell_share", "III.B", 0.9, light.source_to_cell, nan,
                 traced + "; the array as a whole catches 90 %, gaps between cells lose 2 %"});
  all.push_back({"conversion_share", "III.B", 0.38, light.conversion, nan,
                 traced + "; of the light on the cells, 730 ± 15 nm"});
  all.push_back({"array_power_W", "III.B", 30.0, light.power_W, nan, traced});
  all.push_back({"array_power_at_30_deg_W", "III.B", 23.0, light.power_at_30_deg_W, nan,
                 traced + "; every cell at its own best point is the theoretical maximum"});
  const Vec3& torque_N_m = light.torque_at_30_deg_N_m;
  all.push_back({"radiation_torque_traced_at_30_deg_N_m", "II.C.2", 1.127e-9, torque_N_m.y(), nan,
                 traced + "; about y, on the array; about x " + number(torque_N_m.x()) +
                     ", about z " + number(torque_N_m.z()) +
                     " N m, balanced and negligible in the paper; goes with the array's height"});
}

void add_battery(std::vector<PaperFigure>& all) {
  const BatteryCell cell{.electrodes_body_m = {battery_half_length_m, 0.0, 0.0}};
  const auto shift_m = [&](double lithium_per_charge_kg_C) {
    return com_shift_m_C({&cell, 1}, platform_mass_kg, lithium_per_charge_kg_C).norm() *
           battery_charge_C;
  };
  const double exact_m = shift_m(lithium_kg_C), rounded_m = shift_m(lithium_as_published_kg_C);
  const double weight_N = platform_mass_kg * standard_gravity_m_s2;
  const std::string why =
      "Faraday's constant gives 0.2589 g of lithium per Ah, the paper rounds to 0.3; half a cell's "
      "length is an upper bound for wound cells";
  all.push_back({"battery_shift_m", "II.C.3", 3.32e-6, exact_m, rounded_m, why});
  all.push_back(
      {"battery_torque_N_m", "II.C.3", 2.3e-4, weight_N * exact_m, weight_N * rounded_m, why});
  all.push_back({"energy_of_24_h_Wh", "III.B", 360.0, 86400.0 * 25.0 / 3600.0, nan,
                 "25 W for 24 h are 600 Wh; 360 Wh are 15 W"});
}

void add_camera(std::vector<PaperFigure>& all) {
  const Sensors::Camera camera;
  const std::string why = "the default of [sensors.camera], an input";
  all.push_back(
      {"camera_in_plane_arcsec", "III.A", 12.0, camera.noise_rad.z() / arcsecond_rad, nan, why});
  all.push_back({"camera_out_of_plane_arcsec", "III.A", 37.0, camera.noise_rad.x() / arcsecond_rad,
                 nan, why});
}

struct AssumedInput {
  const char* name;
  double PaperInputs::*member;
};
constexpr AssumedInput assumed_inputs[] = {
    {"step_angle_rad", &PaperInputs::step_angle_rad},
    {"screw_lead_m", &PaperInputs::screw_lead_m},
    {"moving_mass_kg", &PaperInputs::moving_mass_kg},
    {"platform_scale", &PaperInputs::platform_scale},
    {"top_plate_side_m", &PaperInputs::top_plate_side_m},
    {"bottom_plate_side_m", &PaperInputs::bottom_plate_side_m},
    {"rail_radius_m", &PaperInputs::rail_radius_m},
    {"rail_length_m", &PaperInputs::rail_length_m},
    {"rail_distance_m", &PaperInputs::rail_distance_m},
    {"cylinder_drag_coefficient", &PaperInputs::cylinder_drag_coefficient},
    {"box_drag_coefficient", &PaperInputs::box_drag_coefficient},
    {"rib_drag_coefficient", &PaperInputs::rib_drag_coefficient},
    {"array_height_m", &PaperInputs::array_height_m},
    {"light_on_cells_W", &PaperInputs::light_on_cells_W},
};

}  // namespace

UnloadedDrag unloaded_drag(const PaperInputs& in) {
  const FilmAir air;
  const double ambient_Pa = air.pressure_Pa;
  const SphericalSocket socket{in.ball_radius_m, in.socket_half_angle_rad, in.rated_gap_m,
                               in.recess_half_angle_rad};
  // The hole area with which the inlet pressure is k_p times the supply pressure at the rated gap.
  const auto feed_of = [&](double log_hole_area) {
    return OrificeFeed{ambient_Pa + in.supply_gauge_Pa, std::exp(log_hole_area)};
  };
  const auto too_small = [&](double log_hole_area) {
    const OrificeFeed trial = feed_of(log_hole_area);
    return orifice_fed_film(socket, trial, air).inlet_Pa < in.inlet_fraction * trial.supply_Pa;
  };
  const OrificeFeed feed = feed_of(bisect(std::log(1e-12), std::log(1e-5), too_small).middle());
  UnloadedDrag result;
  result.rated_load_N = orifice_fed_film(socket, feed, air).load_N;
  result.load_as_published_N =
      load_capacity_as_published_N(socket, in.inlet_fraction * feed.supply_Pa, ambient_Pa);
  const double step_m = 1e-4 * in.rated_gap_m;
  SphericalSocket wider = socket;
  wider.gap_m += step_m;
  const double stiffness_N_m =
      (result.rated_load_N - orifice_fed_film(wider, feed, air).load_N) / step_m;
  const double weight_N = in.ball_mass_kg * standard_gravity_m_s2;
  result.ratio_spring =
      spring_gap_m(in.rated_gap_m, result.rated_load_N, stiffness_N_m, weight_N) / in.rated_gap_m;
  result.ratio_film = gap_under_load_m(socket, feed, air, weight_N) / in.rated_gap_m;
  return result;
}

BearingComparison compare_bearings(std::span<const BearingDatasheet> catalogue, double ambient_Pa,
                                   double viscosity_Pa_s) {
  BearingComparison result;
  int drags = 0;
  for (const BearingDatasheet& b : catalogue) {
    const double ours_N = load_capacity_N(b.socket, b.inlet_Pa, ambient_Pa);
    const double printed_N = load_capacity_as_published_N(b.socket, b.inlet_Pa, ambient_Pa);
    result.load_error += std::abs(ours_N / b.load_N - 1.0);
    result.load_error_as_published += std::abs(printed_N / b.load_N - 1.0);
    if (b.drag_N_m > 0.0) {
      const FilmDrag drag = film_drag(b.socket, viscosity_Pa_s);
      result.drag_ratio += drag.axial_N_m_s * b.drag_rate_rad_s / b.drag_N_m;
      ++drags;
    }
  }
  const auto count = static_cast<double>(catalogue.size());
  result.load_error /= count;
  result.load_error_as_published /= count;
  result.drag_ratio = drags > 0 ? result.drag_ratio / drags : nan;
  return result;
}

std::vector<PaperFigure> paper_figures(const PaperInputs& inputs) {
  std::vector<PaperFigure> all;
  add_structure(all, inputs);
  add_bearing(all, inputs);
  add_air(all, inputs);
  add_fields(all, inputs);
  add_light(all, inputs.light);
  add_battery(all);
  add_camera(all);
  return all;
}

std::vector<PaperSensitivity> paper_sensitivities(const PaperInputs& inputs) {
  constexpr double grow = 1e-4;
  const std::vector<PaperFigure> figures = paper_figures(inputs);
  std::vector<PaperSensitivity> all;
  for (const AssumedInput& assumed : assumed_inputs) {
    PaperInputs moved = inputs;
    moved.*assumed.member *= 1.0 + grow;
    const std::vector<PaperFigure> after = paper_figures(moved);
    for (size_t i = 0; i < figures.size(); ++i) {
      const double exponent = std::log(after[i].ours / figures[i].ours) / std::log1p(grow);
      if (!(std::abs(exponent) > 1e-3)) continue;  // also if the figure is not known
      const double value = inputs.*assumed.member;
      const double factor = std::pow(figures[i].published / figures[i].ours, 1.0 / exponent);
      all.push_back({figures[i].quantity, assumed.name, value, exponent,
                     std::abs(exponent) > 0.5 ? value * factor : nan});
    }
  }
  return all;
}

// The paper's figures as tables and a plot.

namespace {

// Figure 5: both torques as functions of tilt. They are the trigonometric factors of eq. 2 and 3
// relative to their largest values up to 90 deg.
Plot elastic_plot() {
  Plot::Curve dumbbell{"dumbbell"}, tabletop{"tabletop"};
  for (int tilt_deg = 0; tilt_deg <= 90; ++tilt_deg) {
    const double tilt_rad = tilt_deg * degree_rad;
    dumbbell.x.push_back(tilt_deg);
    dumbbell.y.push_back(std::sin(tilt_rad) - 0.5 * std::sin(2.0 * tilt_rad));
    tabletop.x.push_back(tilt_deg);
    tabletop.y.push_back(std::sin(2.0 * tilt_rad));
  }
  return {"elastic_torque_by_tilt",
          "Elastic torque over its largest value, balanced at zero tilt",
          "tilt [deg]",
          "torque / largest torque",
          {dumbbell, tabletop}};
}

Table figures_table(const std::vector<PaperFigure>& figures) {
  Table table = Table::of("paper_figures", "Published figures compared with photorque");
  for (const PaperFigure& f : figures) {
    table.row()
        .set("quantity", f.quantity)
        .set("section", f.section)
        .set("why", f.why)
        .set("published", f.published)
        .set("ours", f.ours)
        .set("ratio", f.ours / f.published)
        .set("ours_as_published", f.as_published);
  }
  return table;
}

Table sensitivities_table(const std::vector<PaperSensitivity>& all) {
  Table table =
      Table::of("paper_sensitivities", "Sensitivity of the figures to unstated dimensions");
  for (const PaperSensitivity& s : all) {
    table.row()
        .set("quantity", s.quantity)
        .set("assumed", s.input)
        .set("value", s.value)
        .set("exponent", s.exponent)
        .set("value_for_published", s.value_for_published);
  }
  return table;
}

}  // namespace

Product paper_product(const PaperInputs& inputs) {
  Table air = air_table(paper_air_parts(inputs).all(), room, one_rpm_rad_s);
  air.name = "paper_external_air";
  air.title = "External air on the paper's platform at 1 rpm, by part";
  Product product;
  product.tables = {figures_table(paper_figures(inputs)),
                    sensitivities_table(paper_sensitivities(inputs)), air};
  product.plots = {elastic_plot()};
  return product;
}

}  // namespace photorque
