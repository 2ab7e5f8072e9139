#include "attitude/propagation/run.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "attitude/disturbances/kind.h"
#include "attitude/environment/epoch.h"
#include "attitude/recordings/apm.h"
#include "attitude/recordings/oem.h"
#include "core/settings/typed_keys.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "core/transform.h"

namespace photorque {

namespace {

constexpr double max_run_s = 1e10;  // three centuries

namespace propagate_key {
constexpr NumberKey duration("duration_s", 600.0, {0.0, max_run_s, true, false},
                             "duration of the run");
constexpr NumberKey output_rate("output_rate_Hz", Range::positive(),
                                "rows of the recording, at most 2e7 in all",
                                {.usually = "10, or a row every 0.2, 0.5, 1, 2, 5 … s where that "
                                            "gives more than 45000 rows"});
constexpr IntegerKey history_rows("history_rows", 5000, 2, 20'000'000,
                                  "rows of `time_history.csv` at most");
constexpr NumberKey tolerance("tolerance", PropagationOptions{}.tolerance,
                              {1e-13, 1e-3, false, false},
                              "estimated error of a step, relative to 1 rad and 1 rad/s");
constexpr NumberKey longest_step("longest_step_s", Range::positive(),
                                 "longest step of the integrator", {.usually = "none"});
constexpr NumberKey tick_rate(
    "tick_rate_Hz", 0.0, {0.0, 1e6, false, false},
    "integration steps also end at ticks of this rate, as in `serve`; 0: no ticks");
constexpr IntegerKey seed("seed", 1, 0, INT64_MAX,
                          "seed of the noise of the sensors; also `--seed`");
constexpr NumberKey initial_tilt("initial_tilt_deg", 0.0, {0.0, pi, false, false},
                                 "tilt at the start, towards `initial_heading_deg`; *or*");
constexpr NumberKey initial_heading("initial_heading_deg", 0.0, {},
                                    "azimuth of the tilt direction at the start");
constexpr NumberKey initial_yaw("initial_yaw_deg", {}, "azimuth of body x at the start",
                                {.usually = "that of a tilt without rotation about body z"});
constexpr NumbersKey initial_attitude(
    "initial_attitude", {},
    "attitude at the start as a unit quaternion [w, x, y, z], lab from body",
    {.optional = true, .size = 4});
constexpr Vec3Key initial_rate("initial_rate_rad_s", {0.0, 0.0, 0.0},
                               "angular rate at the start, body axes");
constexpr NumbersKey initial_position("initial_position_m", {},
                                      "position of a planar platform at the start, lab x and y",
                                      {.usually = "0, 0", .size = 2});
constexpr NumbersKey initial_velocity("initial_velocity_m_s", {},
                                      "velocity of a planar platform at the start, lab x and y",
                                      {.usually = "0, 0", .size = 2});
constexpr IntegerKey initial_turns("initial_turns", 0, -1'000'000, 1'000'000,
                                   "number of whole turns before the start, about the axis of a "
                                   "one-axis platform; they twist a `tether`");
constexpr NumberKey initial_charge("initial_charge_Ah", 0.0, {},
                                   "charge drawn from the battery before the start");
constexpr NumberKey initial_time(
    "initial_time_s", 0.0, {},
    "time of the first row; commands, measured series and functions of time use this time");
constexpr TextKey commands(
    "commands",
    "CSV: `t_s` and any of `command_x_N_m`, `…_y_…`, `…_z_…`, `command_x_N`, `command_y_N` (of "
    "a sliding body), `battery_current_A`, "
    "`led_current_A`, each row held until the next (zero-order hold); `wheel_x_rad_s` …, speeds of "
    "wheels, linear between rows; *or*",
    {.usually = "none"});
constexpr NumberKey time("time_s", {}, "time of the command, rising");
constexpr Vec3Key torque("torque_N_m", {0.0, 0.0, 0.0}, "commanded torque, body axes");
constexpr NumbersKey force("force_N", {}, "commanded force of a planar platform, lab x and y",
                           {.usually = "0, 0", .size = 2});
constexpr NumbersKey force_body("force_body_N", {},
                                "commanded force of a planar platform, body x and y",
                                {.usually = "0, 0", .size = 2});
constexpr NumberKey battery_current("battery_current_A", 0.0, {}, "current drawn from the battery");
constexpr NumberKey led_current("led_current_A", Range::not_negative(),
                                "current of the lamps; not given: constant light",
                                {.optional = true});
constexpr TablesKey command("command", "commands, each of which acts until the next");
constexpr TextKey initial_apm("initial_apm",
                              "CCSDS APM (KVN or XML): attitude and rate at the start, where the "
                              "keys above do not state them",
                              {.optional = true});
constexpr TextKey epoch("epoch",
                        "calendar time of t = 0, UTC, for `attitude.aem` and the `ephemeris` of an "
                        "`orbit`; does not move `igrf` or a circular `orbit`",
                        {.usually = "that of `initial_apm`, else the start of an `ephemeris`, else "
                                    "\"2000-01-01T00:00:00\""});
constexpr TableKey propagate("propagate", "a run of the motion");
}  // namespace propagate_key

Settings of_propagate(const Settings& root) {
  return own_table(root, std::string(propagate_key::propagate.name), false);
}

std::optional<AttitudeParameters> read_initial_apm(const Settings& settings) {
  if (!settings.has(propagate_key::initial_apm)) return std::nullopt;
  return read_apm(file_of(settings, propagate_key::initial_apm));
}

// Calendar time of t = 0 if `epoch` or the initial APM states it.
std::optional<std::string> stated_epoch(const Settings& settings) {
  if (settings.has(propagate_key::epoch)) return settings.get(propagate_key::epoch);
  const std::optional<AttitudeParameters> apm = read_initial_apm(settings);
  return apm ? std::optional(epoch_text(apm->epoch)) : std::nullopt;
}

// Settings with the [[disturbance]] tables only; other readers check the rest of the file. A
// disturbance with an ephemeris but without an epoch receives the stated epoch.
Settings disturbances_of(const Settings& root) {
  SettingsNode list = root.raw("disturbance");
  if (auto* all = std::get_if<SettingsNode::Array>(&list.value)) {
    for (SettingsNode& one : *all) {
      auto* keys = std::get_if<SettingsNode::Table>(&one.value);
      if (keys == nullptr || !keys->contains("ephemeris") || keys->contains("epoch")) continue;
      const std::optional<std::string> epoch = stated_epoch(of_propagate(root));
      if (epoch) (*keys)["epoch"] = {*epoch, one.where};
    }
  }
  SettingsNode holder;
  holder.value = SettingsNode::Table{{"disturbance", std::move(list)}};
  return Settings(std::move(holder));
}

// Sets the calendar time of t = 0 from an ephemeris unless it is stated. InputError if the
// ephemeris does not cover the run.
void take_ephemeris(const Settings& root, bool is_stated, PropagationRun& run) {
  if (!root.has("disturbance")) return;
  for (const Settings& one : disturbances_of(root).tables("disturbance")) {
    if (!one.has("ephemeris")) continue;
    const OrbitEphemeris states(file_of(one, "ephemeris"));
    if (!is_stated) run.epoch = one.has("epoch") ? one.text("epoch") : epoch_text(states.start());
    const std::optional<Epoch> zero = parse_epoch(one.text_or("epoch", run.epoch));
    if (!zero) return;  // the orbit's reader reports it
    const double begin_s = zero->seconds_since(states.start()) + run.initial.time_s;
    const double end_s = begin_s + run.duration_s;
    if (begin_s >= 0.0 && end_s <= states.duration_s()) return;
    const Settings settings = of_propagate(root);
    const bool is_late = begin_s >= 0.0;
    throw settings.error(
        is_late ? propagate_key::duration.name : propagate_key::initial_time.name,
        is_late ? "an end " + shortest(end_s - states.duration_s()) + " s after the ephemeris"
                : "a start " + shortest(-begin_s) + " s before the ephemeris",
        "a run between " + epoch_text(states.start()) + " and " +
            epoch_text(states.start().after(states.duration_s())) + " UTC");
  }
}

bool names_effect_of_bearing(const Settings& root) {
  if (!root.has("disturbance")) return false;
  const std::vector<Settings> all = disturbances_of(root).tables("disturbance");
  return std::any_of(all.begin(), all.end(), [](const Settings& disturbance) {
    const DisturbanceKind* kind = find_kind(disturbance.text_or("kind", ""));
    return kind != nullptr && (kind->screening.needs == Requirement::bearing ||
                               kind->screening.needs == Requirement::air_bearing);
  });
}

std::vector<Disturbance> read_own_disturbances(const Settings& root,
                                               const DisturbanceContext& context) {
  if (!root.has("disturbance")) return {};
  const Settings own = disturbances_of(root);
  std::vector<Disturbance> disturbances = read_disturbances(own, context);
  own.finish();
  return disturbances;
}

// Two numbers along x and y; zero if the key is absent.
Vec3 in_plane(const Settings& settings, const NumbersKey& key) {
  if (!settings.has(key)) return Vec3::Zero();
  const std::vector<double> two = settings.get(key);
  if (two.size() != 2) {
    throw settings.error(key, std::to_string(two.size()) + " numbers", "two, along x and y");
  }
  return {two[0], two[1], 0.0};
}

Schedule read_schedule(const Settings& settings) {
  if (settings.has(propagate_key::commands)) {
    // An empty list replaces the commands of the file by none, and is allowed.
    if (settings.has(propagate_key::command) && !settings.get(propagate_key::command).empty()) {
      throw settings.error(propagate_key::command, "[[propagate.command]] beside commands",
                           "one of the two");
    }
    return read_command_file(file_of(settings, propagate_key::commands));
  }
  Schedule schedule;
  std::optional<double> before_s;
  for (const Settings& command : settings.get(propagate_key::command)) {
    const double time_s = command.get(propagate_key::time);
    if (before_s && time_s <= *before_s) {
      throw command.error(propagate_key::time,
                          std::to_string(time_s) + " after " + std::to_string(*before_s),
                          "commands in order of time");
    }
    before_s = time_s;
    ZeroOrderHold held{.command_body_N_m = command.get(propagate_key::torque),
                       .force_lab_N = in_plane(command, propagate_key::force),
                       .force_body_N = in_plane(command, propagate_key::force_body),
                       .battery_current_A = command.get(propagate_key::battery_current)};
    if (command.has(propagate_key::led_current)) {
      held.led_current_A = command.get(propagate_key::led_current);
      held.lamps_as_stated = 0.0;
    }
    schedule.append(time_s, held);
  }
  return schedule;
}

// Attitude with the tilt of `lean` and body x at the azimuth that [propagate] states.
Quat with_initial_yaw(const Settings& settings, const Quat& lean) {
  const double yaw_rad = settings.get(propagate_key::initial_yaw);
  const Vec3 up = lean * Vec3::UnitZ(), level(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
  constexpr double least = 1e-6;  // cosine of the tilt: below, body x has no azimuth
  if (std::abs(up.z()) < least) {
    throw settings.error(propagate_key::initial_yaw, "a tilt of 90 deg",
                         "initial_attitude instead: at this tilt, the yaw cannot be chosen");
  }
  // Body x is perpendicular to body z, above or below the horizontal line of that azimuth.
  const Vec3 x = (std::abs(up.z()) * level -
                  std::copysign(up.dot(level), up.z() * up.dot(level)) * Vec3::UnitZ())
                     .normalized();
  Mat3 axes;
  axes << x, up.cross(x), up;
  return Quat(axes);
}

Quat read_initial_attitude(const Settings& settings, const std::optional<AttitudeParameters>& apm) {
  const bool tilts =
      settings.has(propagate_key::initial_tilt) || settings.has(propagate_key::initial_yaw);
  if (apm && !tilts && !settings.has(propagate_key::initial_attitude)) return apm->lab_from_body;
  if (!settings.has(propagate_key::initial_attitude)) {
    const double tilt_rad = settings.get(propagate_key::initial_tilt);
    const double heading_rad = settings.get(propagate_key::initial_heading);
    const Quat lean = lab_from_body_at(tilt_rad, heading_rad).rotation;
    return settings.has(propagate_key::initial_yaw) ? with_initial_yaw(settings, lean) : lean;
  }
  const std::vector<double> q = settings.get(propagate_key::initial_attitude);
  if (q.size() != 4) {
    throw settings.error(propagate_key::initial_attitude, std::to_string(q.size()) + " numbers",
                         "a quaternion [w, x, y, z]");
  }
  const Quat attitude(q[0], q[1], q[2], q[3]);
  if (!(std::abs(attitude.norm() - 1.0) < 1e-3)) {
    throw settings.error(propagate_key::initial_attitude,
                         printed("a quaternion of norm %g", attitude.norm()),
                         "a quaternion of unit norm");
  }
  return attitude.normalized();
}

// InputError if a platform on bearings with one axis is tilted or turns about another axis at the
// start.
void check_begins_about_axis(const Settings& settings, const Platform& platform,
                             const Quat& lab_from_body, const Vec3& rate_rad_s) {
  if (!platform.turns_about_one_axis()) {
    if (!settings.has(propagate_key::initial_turns)) return;
    throw settings.error(propagate_key::initial_turns, "a platform with several axes",
                         "topology = \"one_axis\" or no whole turns");
  }
  const auto beside = [&](const Vec3& v) {
    return (v - platform.axis.dot(v) * platform.axis).norm();
  };
  constexpr double rounding = 1e-6;
  if (beside(rate_rad_s) > rounding * rate_rad_s.norm()) {
    throw settings.error(propagate_key::initial_rate,
                         "a rate about another axis than that of the bearings",
                         "a rate about platform.axis only");
  }
  if (beside(lab_from_body.vec()) > rounding) {
    throw settings.error(
        settings.has(propagate_key::initial_attitude) ? propagate_key::initial_attitude.name
                                                      : propagate_key::initial_tilt.name,
        "a rotation about an axis that the bearings block", "a rotation about platform.axis only");
  }
}

}  // namespace

Settings own_table(const Settings& root, const std::string& key, bool required) {
  if (!root.has(key) && !required) return Settings(SettingsNode{}, key);
  const Settings table = root.table(key);  // InputError if it is not a table
  return Settings(root.raw(key), table.name());
}

namespace {

// A disturbance of the kind for inertia errors, with value zero and the sigmas of [platform].
Disturbance uncertain_inertia(const Mat3& sigma_kg_m2, const DisturbanceContext& context) {
  // The only kind that changes the inertia.
  const auto& kinds = disturbance_kinds();
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [](const DisturbanceKind& k) {
    return k.screening.inertia_change_kg_m2 != nullptr;
  });
  Disturbance error =
      make_disturbance_of(kind->name, {{"delta_kg_m2", {0, 0, 0, 0, 0, 0}}}, context);
  const Mat3& s = sigma_kg_m2;
  const double six[] = {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(0, 2), s(1, 2)};
  for (size_t i = 0; i < error.parameters.size(); ++i) error.parameters[i].sigma = six[i];
  return error;
}

// A disturbance of the kind for mass errors, with value zero and sigma `sigma_kg`.
Disturbance uncertain_mass(double sigma_kg, const DisturbanceContext& context) {
  const auto kind = std::ranges::find_if(
      disturbance_kinds(), [](const DisturbanceKind& k) { return k.screening.changes_mass; });
  Disturbance error = make_disturbance_of(kind->name, {{kind->keys.front().name, {0.0}}}, context);
  error.parameters.front().sigma = sigma_kg;
  return error;
}

// InputError if a disturbance depends on the ambient magnetic field, but neither [environment] nor
// another disturbance states the field.
void require_magnetic_field(const Settings& environment, const AttitudeModel& model) {
  if (environment.has("magnetic_field_T") || environment.has("igrf")) return;
  const DisturbanceKind* needy = nullptr;
  for (const Disturbance& one : model.disturbances) {
    const DisturbanceKind* kind = find_kind(one.kind);
    if (kind == nullptr) continue;
    if (kind->sets == std::string_view("the magnetic field")) return;
    if (kind->screening.needs == Requirement::field) needy = kind;
  }
  if (needy == nullptr) return;
  throw environment.error("magnetic_field_T", "no magnetic field, which " + needy->name + " needs",
                          "magnetic_field_T or igrf in [environment]");
}

}  // namespace

DisturbanceContext NominalModel::context() const {
  const bool sees_markers = sensors.camera && sensors.camera->geometry;
  return {model.platform, model.environment, sees_markers ? &*sensors.camera->geometry : nullptr};
}

NominalModel read_attitude_model(const Settings& root) {
  const Settings platform = own_table(root, "platform", true);
  const Settings environment = own_table(root, "environment", false);
  const Settings sensors = own_table(root, "sensors", false);
  NominalModel nominal;
  AttitudeModel& model = nominal.model;
  model.platform = read_platform(platform);
  model.platform.has_effects_of_bearing = names_effect_of_bearing(root);
  model.environment = read_environment(environment);
  // A freely falling body, or one in orbit about the Sun, is weightless.
  const bool is_in_space = !model.platform.has_bearing() || model.environment.sun;
  if (is_in_space && !environment.has("gravity_m_s2")) {
    model.environment.gravity_lab_m_s2 = Vec3::Zero();
  }
  // read_sensors() checks the keys of the camera later.
  std::optional<TrackingCamera> camera;
  if (sensors.has("camera")) camera = read_tracking_camera(sensors.table("camera"));
  const DisturbanceContext context{model.platform, model.environment, camera ? &*camera : nullptr};
  model.disturbances = read_own_disturbances(root, context);
  require_magnetic_field(environment, model);
  if (model.platform.slides()) model.disturbances.push_back(translation());
  if (const double sigma_kg = mass_sigma_kg(platform); sigma_kg > 0.0) {
    model.disturbances.push_back(uncertain_mass(sigma_kg, context));
  }
  if (const Mat3 sigma = inertia_sigma_kg_m2(platform); sigma.maxCoeff() > 0.0) {
    nominal.uncertain_inertia = model.disturbances.size();
    model.disturbances.push_back(uncertain_inertia(sigma, context));
  }
  nominal.sensors = root.has("sensors") ? read_sensors(sensors, context) : perfect_sensors();
  model.disturbances.insert(model.disturbances.end(), nominal.sensors.errors.begin(),
                            nominal.sensors.errors.end());
  for (const Settings& settings : {platform, environment, sensors}) settings.finish();
  return nominal;
}

// Default output rate: at most 45000 rows. A row has up to 220 bytes, so a recording has at most 10
// MB.
double usual_output_rate_Hz(double duration_s) {
  constexpr double most_rows = 45000.0;
  for (double decade = 0.1;; decade *= 10.0) {
    for (const double mantissa : {1.0, 2.0, 5.0}) {
      if (duration_s <= most_rows * mantissa * decade) return 1.0 / (mantissa * decade);
    }
  }
}

namespace {

// Reads position and velocity at the start, zero by default, of a platform that slides.
void read_initial_place(const Settings& settings, const AttitudeModel& model,
                        PlatformState& initial) {
  const int first = Dynamics(model).first_of_translation();
  if (first < 0) return;
  auto to = initial.extra.begin() + (first - component::extra);
  for (const NumbersKey& key : {propagate_key::initial_position, propagate_key::initial_velocity}) {
    const Vec3 place = in_plane(settings, key);
    to = std::copy(place.begin(), place.begin() + 2, to);
  }
}

// The state at the start. InputError if bearings, stops or battery do not allow it.
PlatformState read_initial_state(const Settings& settings, const AttitudeModel& model) {
  const std::optional<AttitudeParameters> apm = read_initial_apm(settings);
  Vec3 rate_body_rad_s = settings.get(propagate_key::initial_rate);
  if (apm && apm->rate_body_rad_s && !settings.has(propagate_key::initial_rate)) {
    rate_body_rad_s = *apm->rate_body_rad_s;
  }
  const Quat attitude = read_initial_attitude(settings, apm);
  const double angle_rad = model.platform.axis.dot(turn_vector(attitude)),
               turns_rad =
                   2.0 * pi * static_cast<double>(settings.get(propagate_key::initial_turns));
  PlatformState initial = Dynamics(model).initial_state(rate_body_rad_s, angle_rad + turns_rad);
  initial.lab_from_body = attitude;
  check_begins_about_axis(settings, model.platform, initial.lab_from_body, initial.rate_body_rad_s);
  read_initial_place(settings, model, initial);
  const double tilt_rad =
      std::acos(std::clamp(initial.lab_from_body.toRotationMatrix()(2, 2), -1.0, 1.0));
  const std::optional<double> limit_rad = model.platform.tilt_limit_rad;
  if (limit_rad && tilt_rad > *limit_rad) {
    throw settings.error(settings.has(propagate_key::initial_attitude)
                             ? propagate_key::initial_attitude.name
                             : propagate_key::initial_tilt.name,
                         "a tilt of " + std::to_string(tilt_rad / degree_rad) + " deg",
                         "at most platform.tilt_limit_deg");
  }
  initial.charge_drawn_C = settings.get(propagate_key::initial_charge);
  const std::optional<double>& capacity_C = model.platform.battery_capacity_C;
  if (capacity_C && initial.charge_drawn_C > *capacity_C) {
    throw settings.error(
        propagate_key::initial_charge, std::to_string(initial.charge_drawn_C / 3600.0) + " drawn",
        "at most the " + std::to_string(*capacity_C / 3600.0) + " of platform.battery_capacity_Ah");
  }
  initial.time_s = settings.get(propagate_key::initial_time);
  return initial;
}

// InputError for a law of a wheel that neither its key nor a file gives a speed. Without one, it
// would exert no torque.
void require_wheel_speeds(const Settings& settings, const AttitudeModel& model) {
  constexpr const char* speed = "speed_rad_s";
  const bool has_speeds = std::ranges::any_of(
      model.schedule.held, [](const ZeroOrderHold& held) { return held.wheel != WheelSpeeds{}; });
  if (has_speeds) return;
  for (const Disturbance& d : model.disturbances) {
    const DisturbanceKind* kind = find_kind(d.kind);
    if (kind == nullptr || kind->screening.needs != Requirement::wheel ||
        std::ranges::find(kind->keys, speed, &Key::name) == kind->keys.end() ||
        std::ranges::find(d.parameters, speed, &Parameter::key) != d.parameters.end()) {
      continue;
    }
    throw settings.error(propagate_key::commands, "no speed of the wheel of " + d.kind,
                         std::string("its key ") + speed +
                             ", or a file with wheel_x_rad_s, wheel_y_rad_s or wheel_z_rad_s");
  }
}

}  // namespace

PropagationRun read_propagation(const Settings& root) {
  NominalModel nominal = read_attitude_model(root);
  PropagationRun run;
  run.model = std::move(nominal.model);
  run.sensors = std::move(nominal.sensors);
  const Settings settings = own_table(root, "propagate", false);
  run.duration_s = settings.get(propagate_key::duration);
  run.output_rate_Hz =
      settings.get_or(propagate_key::output_rate, usual_output_rate_Hz(run.duration_s));
  constexpr double max_rows = 2e7;
  if (run.duration_s * run.output_rate_Hz > max_rows) {
    throw settings.error(propagate_key::output_rate, "more than 20 million rows", "a lower rate");
  }
  run.history_rows = static_cast<size_t>(settings.get(propagate_key::history_rows));
  run.seed = static_cast<uint64_t>(settings.get(propagate_key::seed));
  run.options.tolerance = settings.get(propagate_key::tolerance);
  run.options.max_step_s = settings.get_or(propagate_key::longest_step, run.options.max_step_s);
  if (run.duration_s / run.options.max_step_s > static_cast<double>(run.options.max_steps)) {
    throw settings.error(propagate_key::longest_step,
                         "more than a thousand million steps to the end", "longer steps");
  }
  run.options.tick_rate_Hz = settings.get(propagate_key::tick_rate);
  run.model.schedule = read_schedule(settings);
  require_wheel_speeds(settings, run.model);
  const std::optional<std::string> epoch = stated_epoch(settings);
  run.epoch = epoch.value_or("2000-01-01T00:00:00");
  if (!parse_epoch(run.epoch)) {
    throw settings.error(propagate_key::epoch, "\"" + run.epoch + "\"",
                         "a time as 2000-01-01T12:00:00");
  }
  // Times of a run do not count leap seconds.
  if (run.epoch.find(":60") != std::string::npos) {
    throw settings.error(propagate_key::epoch, "\"" + run.epoch + "\"", "no leap second");
  }
  run.initial = read_initial_state(settings, run.model);
  take_ephemeris(root, epoch.has_value(), run);
  // The year of a calendar time in attitude.aem has four digits.
  const double left_s = parse_epoch("9999-12-31T23:59:59")->seconds_since(*parse_epoch(run.epoch));
  if (run.initial.time_s + run.duration_s > left_s) {
    throw settings.error(propagate_key::epoch, "an end after the year 9999", "an earlier time");
  }
  settings.finish();
  return run;
}

Key propagate_table() {
  using namespace propagate_key;
  return propagate_key::propagate.of(
      {duration,
       output_rate,
       history_rows,
       tolerance,
       longest_step,
       tick_rate,
       seed,
       initial_tilt,
       initial_heading,
       initial_yaw,
       initial_turns,
       initial_attitude,
       initial_rate,
       initial_apm,
       initial_position,
       initial_velocity,
       initial_charge,
       initial_time,
       commands,
       command.of({time, torque, force, force_body, battery_current, led_current}),
       epoch});
}

}  // namespace photorque
