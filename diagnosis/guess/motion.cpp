#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "attitude/estimation/free_inertia.h"
#include "attitude/estimation/segments.h"
#include "attitude/estimation/swing.h"
#include "attitude/observation/noise_levels.h"
#include "attitude/recordings/aem.h"
#include "attitude/recordings/columns.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "diagnosis/guess/file_head.h"
#include "diagnosis/guess/guess.h"
#include "diagnosis/guess/header.h"
#include "diagnosis/guess/places.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

constexpr size_t fewest_readings = 20;  // minimum for an Observation

std::string digits(double value, int significant = 3) {
  return printed("%.*g", significant, value);
}

double rounded(double value, int significant = 6) {
  return std::strtod(digits(value, significant).c_str(), nullptr);
}

SettingsNode number_node(double value) {
  return {rounded(value, 3)};
}

// Properties of a machine that the columns and readings of its recordings determine.
struct Machine {
  Platform platform;
  std::string why;  // reason for the topology
  std::vector<Recording> recordings;
  std::vector<std::string> names;
  std::vector<Observation> runs;
  std::optional<AngleConvention>
      angles;  // convention of roll, pitch and yaw of the first recording
  // Gyro axis whose rates are taken as those about `platform.axis`, if the two axes differ.
  std::optional<int> rate_from;

  bool has(const char* channel) const { return recordings.front().find(channel) != nullptr; }
  bool has_one_of(std::initializer_list<const char*> channels) const {
    return std::ranges::any_of(channels, [&](const char* c) { return has(c); });
  }
  bool has_all(std::initializer_list<const char*> channels) const {
    return std::ranges::all_of(channels, [&](const char* c) { return has(c); });
  }
  bool sees_attitude() const {
    return has_all({"q_w", "q_x", "q_y", "q_z"}) || has_all({"roll_rad", "pitch_rad", "yaw_rad"});
  }
  bool has_three_rates() const { return has_all({"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"}); }
  bool is_commanded() const {
    return std::ranges::any_of(recordings.front().schedule().held, [](const ZeroOrderHold& held) {
      return held.commands_torque() || held.commands_force();
    });
  }
  void observe_as(Topology topology, const Vec3& axis = Vec3::UnitZ()) {
    platform.topology = topology;
    platform.axis = axis;
    runs.clear();
    for (size_t i = 0; i < recordings.size(); ++i) {
      Segments segments = observe_segments(recordings[i], names[i], platform);
      if (i == 0) angles = segments.angles;
      std::move(segments.all.begin(), segments.all.end(), std::back_inserter(runs));
    }
  }
};

SettingsNode vector_node(const Vec3& v) {
  return {SettingsNode::Array{number_node(v.x()), number_node(v.y()), number_node(v.z())}};
}

SettingsNode matrix(const Mat3& m) {
  SettingsNode::Array rows;
  for (int i = 0; i < 3; ++i) rows.push_back(vector_node(m.row(i)));
  return {std::move(rows)};
}

SettingsNode::Table& add_machine(TomlDocument& document, const Machine& m) {
  SettingsNode::Table& table = document.table("platform");
  const auto set = [&](const char* key, SettingsNode value) {
    document.set(table, key, std::move(value));
  };
  document.comment("CONFIRM: " + m.why);
  switch (m.platform.topology) {
    case Topology::free:
      set("topology", {"free"});
      break;
    case Topology::one_axis: {
      Eigen::Index axis = 2;
      m.platform.axis.maxCoeff(&axis);
      set("topology", {"one_axis"});
      set("axis", {std::string(1, "xyz"[axis])});
      document.comment(
          "Motion alone determines no moment of inertia: it is 1, and torques are normalised by "
          "it.");
      break;
    }
    case Topology::planar:
      set("topology", {"planar"});
      document.comment(
          "Motion alone determines no mass: it is 1, and forces are normalised by it.");
      break;
    default:
      set("topology", {"tabletop"});
      document.comment(
          "CONFIRM: neither can be read from a recording; torques and offsets of the "
          "centre of mass scale with them.");
      set("mass_kg", {int64_t{10}});
      set("inertia_kg_m2", matrix(Vec3::Constant(0.1).asDiagonal()));
  }
  return table;
}

// Most of the changes of the rates that inertia may leave, of those of a free body.
constexpr double explains = 0.2;

// Adds ratios of the moments of inertia as far as rates alone determine them.
void add_inertia(TomlDocument& document, SettingsNode::Table& table,
                 const std::vector<Observation>& runs) {
  const std::optional<FreeInertia> found = free_inertia(runs);
  Mat3 value = Mat3::Identity(), sigma;
  // If all moments are equal, the magnitude of the rate is constant to first order and does not
  // determine them. Different moments are therefore assumed.
  if (!runs.front().has_gyro) value.diagonal() << 1.0, 0.8, 0.6;
  sigma << 0, 0.2, 0.2, 0.2, 0.4, 0.2, 0.2, 0.2, 0.4;
  constexpr double worth_saying = 0.1;
  const bool is_known = found && found->left < explains && found->sigma(0) < worth_saying &&
                        found->sigma(1) < worth_saying && found->sigma(2) < worth_saying;
  std::string why = "CONFIRM: the rates do not determine the ratios of the moments; guessed.";
  if (is_known) {
    // The first moment is the unit. Unknown torques shift the ratios by more than their standard
    // errors.
    const InertiaNumbers in_first = found->value / found->value[0];
    constexpr double of_moment = 0.1, errors = 5.0;
    const auto uncertain = [&](int k, double scale) {
      return std::hypot(errors * found->sigma(k) / found->value[0], of_moment * scale);
    };
    value.diagonal() = in_first.head<3>();
    sigma.setZero();
    const int row[] = {0, 0, 1}, column[] = {1, 2, 2};
    for (int k = 1; k < 3; ++k) sigma(k, k) = uncertain(k, in_first[k]);
    for (int k = 0; k < 3; ++k) {
      const double scale = std::sqrt(in_first[row[k]] * in_first[column[k]]);
      sigma(row[k], column[k]) = sigma(column[k], row[k]) = uncertain(3 + k, scale);
    }
    why =
        "CONFIRM: ratios of the moments for which the rates agree with torque-free motion; they "
        "explain " +
        digits(100.0 * (1.0 - found->left * found->left), 4) +
        " % of the changes of the rates. The sigmas allow for unknown torques.";
  }
  document.comment(
      "Motion without a known torque determines ratios of moments only: Ixx is 1. State a measured "
      "moment for torques in N m.");
  document.comment(why);
  document.set(table, "inertia_kg_m2.value", matrix(value));
  document.set(table, "inertia_kg_m2.sigma", matrix(sigma));
}

// Adds the noise of some channels if their levels agree.
void add_noise(TomlDocument& document, const std::vector<Observation>& runs,
               const std::vector<int>& channels, const std::string& key, double unit) {
  std::vector<double> levels;
  for (const int channel : channels) {
    if (const auto level = reading_level(runs, channel)) levels.push_back(*level / unit);
  }
  if (levels.empty()) return;
  const auto [least, most] = std::minmax_element(levels.begin(), levels.end());
  constexpr double alike = 2.0;
  if (*most > alike * *least) {
    const std::string all =
        joined_text(levels, ", ", [&](const double level) { return digits(level); });
    return document.comment(
        "Neighbouring readings scatter by " + all + " (sensors." + key +
        "), which differs from axis to axis: it is left out, and diagnose finds it.");
  }
  double square = 0.0;
  for (const double level : levels) square += level * level;
  document.set(document.table("sensors"), key,
               number_node(std::sqrt(square / static_cast<double>(levels.size()))),
               "by which neighbouring readings scatter");
}

// A gyro that reads a rate at rest, after a motion about one axis of which only rates are known.
void add_gyro_bias(TomlDocument& document, const Machine& m) {
  constexpr double significant = 5.0;
  for (const Observation& seen : m.runs) {
    const auto rest = reading_at_rest(seen, m.platform.axis);
    if (!rest || std::abs(rest->rate_rad_s) < significant * rest->sigma_rad_s) continue;
    const Vec3 value = rest->rate_rad_s * m.platform.axis + Vec3::Zero(),  // no -0
        sigma = rest->sigma_rad_s * m.platform.axis.cwiseAbs();
    SettingsNode::Table& sensors = document.table("sensors");
    document.set(sensors, "gyro.bias_rad_s.value", vector_node(value),
                 "CONFIRM: gyro reading at rest, at the end of the recording");
    document.set(sensors, "gyro.bias_rad_s.sigma", vector_node(sigma));
    return;
  }
}

// Reason for the restoring law of an oscillation, from the readings.
std::string restoring_law_text(RestoringLaw law, const std::string& seen) {
  return law == RestoringLaw::spring
             ? seen +
                   ", driven back in proportion to the angle and not to its sine: a torsion "
                   "pendulum, a spring (\"x\" for a weight about a level axis)."
             : seen +
                   ": a pendulum about a horizontal axis (\"z\" where the axis is vertical and "
                   "another torque restores it). At angle zero, the pendulum hangs vertically.";
}

RestoringLaw law_of_swing(const std::vector<Observation>& runs, const Vec3& axis) {
  RestoringLaw law = RestoringLaw::unclear;
  for (const Observation& seen : runs) {
    const RestoringLaw of_run = restoring_law(seen, axis);
    if (of_run != RestoringLaw::unclear) law = of_run;
    if (law == RestoringLaw::spring) break;
  }
  return law;
}

// Whether the body turns over a weight about `axis` in a run.
bool turns_over_weight(const std::vector<Observation>& runs, const Vec3& axis) {
  return std::ranges::any_of(
      runs, [&](const Observation& run) { return !angles_over_weight(run, axis).row.empty(); });
}

constexpr const char* over_weight =
    " that shows a torque once per turn: an unbalance about a level axis (\"z\" where the axis is "
    "vertical).";

// Detects a swing, or a turning over a weight, in the rates about body axis `k` and sets the axis
// of the platform. A weight acts about a level axis. For a spring the upright axis is assumed. If
// that is not axis `k`, the rates about `k` are taken as those about the platform's axis. Returns
// whether there is one.
bool infer_restoring_from_rates(Machine& m, int k, const std::string& seen = "one rate") {
  const Vec3 axis = Vec3::Unit(k);
  const bool swings = std::ranges::any_of(
      m.runs, [&](const Observation& run) { return !angles_of_swing(run, axis).row.empty(); });
  if (!swings && !turns_over_weight(m.runs, axis)) return false;
  const RestoringLaw law = swings ? law_of_swing(m.runs, axis) : RestoringLaw::weight;
  m.why =
      swings ? restoring_law_text(law, seen + " that crosses zero repeatedly") : seen + over_weight;
  const bool is_spring = law == RestoringLaw::spring;
  if (is_spring == (k == 2)) return true;
  m.rate_from = k;
  m.platform.axis = is_spring ? Vec3::UnitZ() : Vec3::UnitX();
  return true;
}

// Selects the axis of rotation, and whether weight may act as a restoring torque.
void infer_one_axis(Machine& m) {
  for (int k = 0; k < 3; ++k) {
    if (!m.has((std::string("gyro_") + "xyz"[k] + "_rad_s").c_str())) continue;
    m.observe_as(Topology::one_axis, Vec3::Unit(k));
    if (infer_restoring_from_rates(m, k)) return;
    m.why = std::string("the one gyro axis is ") + "xyz"[k] + ", so it turns about that alone.";
    return;
  }
  const bool has_angle = !m.has("rate_rad_s") || m.has("angle_rad") || m.has("roll_rad");
  m.why = std::string("there is one ") + (has_angle ? "angle" : "rate") +
          " alone, so it turns about one axis: a wheel, a turntable, one angle of a spacecraft.";
  m.observe_as(Topology::one_axis);
  if (!has_angle) {
    if (infer_restoring_from_rates(m, 2) && m.rate_from) {
      m.rate_from.reset();
      m.observe_as(Topology::one_axis, m.platform.axis);
    }
    return;
  }
  const bool is_swing = swings(m.runs, Vec3::UnitZ());
  if (!is_swing && !turns_over_weight(m.runs, Vec3::UnitZ())) return;
  const RestoringLaw law = is_swing ? law_of_swing(m.runs, Vec3::UnitZ()) : RestoringLaw::weight;
  m.why = is_swing ? restoring_law_text(law, "one angle that swings about its mean")
                   : std::string("one angle") + over_weight;
  if (law != RestoringLaw::spring) m.observe_as(Topology::one_axis, Vec3::UnitX());
}

// An angle relative to the vertical, or the magnitude of a rate, belongs to a body that turns about
// more than one axis.
bool infer_from_scalars(Machine& m) {
  if (m.sees_attitude() || m.has_three_rates()) return false;
  if (m.has("rate_magnitude_rad_s")) {
    m.why =
        "only the magnitude of the rate: assumed to be a free body (thrown or in orbit). On a "
        "bearing it is \"tabletop\", which requires mass_kg.";
    m.observe_as(Topology::free);
    return true;
  }
  if (!m.has("tilt_rad") && !(m.has("roll_rad") && m.has("pitch_rad"))) return false;
  m.why =
      "angles against the vertical alone: a platform on a bearing that leans. About one axis it is "
      "\"one_axis\".";
  m.observe_as(Topology::tabletop);
  return true;
}

void infer_machine(Machine& m) {
  const bool has_x = m.has("x_m"), has_y = m.has("y_m");
  if (has_x && has_y) {
    m.why =
        "two coordinates and no third: something slides on a level plane, and gravity is "
        "9.80665 m/s² across it.";
    return m.observe_as(Topology::planar);
  }
  if (!m.has_one_of({"angle_rad", "roll_rad", "pitch_rad", "yaw_rad", "rate_rad_s", "q_w",
                     "tilt_rad", "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s",
                     "rate_magnitude_rad_s"}) &&
      m.has_one_of({"x_m", "y_m", "velocity_x_m_s", "velocity_y_m_s"})) {
    m.why = std::string(has_x || has_y ? "one coordinate" : "a speed") +
            " along a line: a cart on a track, a mass on a spring, a vehicle. Gravity is "
            "9.80665 m/s² across it; the weight of what hangs is part of the spring's pull.";
    return m.observe_as(Topology::planar);
  }
  if (infer_from_scalars(m)) return;
  if (!m.sees_attitude() && !m.has_three_rates()) return infer_one_axis(m);
  m.why =
      "three rates without attitude: assumed to be a free body (thrown, in orbit, on gimbals). On "
      "a bearing or with a weight off the centre it is \"tabletop\", which requires mass_kg.";
  if (!m.sees_attitude()) {
    m.observe_as(Topology::free);
    const bool is_held = has_no_mean_rate(m.runs);
    if (const std::optional<int> swung = axis_of_swing(m.runs, is_held ? 0.5 : 0.2)) {
      m.observe_as(Topology::one_axis, Vec3::Unit(*swung));
      if (infer_restoring_from_rates(m, *swung,
                                     std::string("three rates along one line, that about ") +
                                         "xyz"[*swung] + " the largest one")) {
        return;
      }
      m.observe_as(Topology::free);
    }
    const std::optional<int> axis = only_axis(m.runs);
    if (!axis && is_held) {
      m.why =
          "three rates without a mean: a free body would keep its sense of rotation about one "
          "axis. "
          "Something carries it.";
      m.observe_as(Topology::tabletop);
    }
    if (!axis) return;
    m.why = std::string("three rates, of which that about ") + "xyz"[*axis] +
            " contains more than 95 % of the rotation: one axis.";
    return m.observe_as(Topology::one_axis, Vec3::Unit(*axis));
  }
  if (is_in_space(m.names.front())) {
    m.why = "an attitude relative to an inertial frame: a free body in orbit.";
    return m.observe_as(Topology::free);
  }
  m.observe_as(Topology::tabletop);
  const std::optional<FreeInertia> found = free_inertia(m.runs);
  if (found && found->left < explains && !m.is_commanded()) {
    m.why = "the rates agree with torque-free motion: a free body.";
    return m.observe_as(Topology::free);
  }
  m.why =
      "an attitude about three axes that does not follow from inertia alone: a platform on a "
      "bearing (\"free\" for a body in orbit or thrown).";
}

// Removes the velocity of a coordinate that is also recorded: it is usually computed from the
// coordinate.
std::vector<GuessedColumn> without_computed_velocity(std::vector<GuessedColumn> columns) {
  for (const std::string axis : {"x", "y"}) {
    const bool has_place = std::ranges::any_of(
        columns, [&](const GuessedColumn& c) { return c.channel.starts_with(axis + "_"); });
    for (GuessedColumn& c : columns) {
      if (has_place && c.channel.starts_with("velocity_" + axis)) c.channel.clear();
    }
  }
  return columns;
}

RecordingOptions options_of(const std::vector<GuessedColumn>& columns,
                            const RecordingOptions& reading) {
  RecordingOptions options = reading;
  for (const GuessedColumn& c : columns) {
    if (c.channel.empty() || c.channel == c.in_file) continue;
    options.columns[c.channel] = c.in_file;
  }
  return options;
}

void add_columns(TomlDocument& document, const std::vector<GuessedColumn>& columns) {
  for (const GuessedColumn& c : columns) {
    if (!c.unknown_unit.empty()) {
      document.comment("CONFIRM: the column " + in_quotes(c.in_file) + " is left out: its unit " +
                       in_quotes(c.unknown_unit) + " is unknown.");
    }
    if (c.channel.empty() || c.channel == c.in_file) continue;
    if (!c.is_sure) document.comment("CONFIRM: " + c.because + " the next column.");
    document.set(document.table("recording"), "columns." + c.channel, {c.in_file});
  }
}

// Renames the rates about body axis `k` to rates about the single axis of rotation.
std::vector<GuessedColumn> with_rate_from(std::vector<GuessedColumn> columns, int k) {
  const std::string gyro = std::string("gyro_") + "xyz"[k];
  for (GuessedColumn& c : columns) {
    if (c.channel.starts_with(gyro)) c.channel = "rate" + c.channel.substr(gyro.size());
  }
  return columns;
}

// Throws InputError for a file without a time or without a channel of motion.
void require_motion(const fs::path& path, const std::vector<GuessedColumn>& columns,
                    const RecordingOptions& reading) {
  if (is_aem(path)) return;
  const auto any = [&columns](const auto& is) { return std::ranges::any_of(columns, is); };
  const bool counts = any([](const GuessedColumn& c) { return c.channel == "frame"; });
  const bool has_clock = reading.rate_Hz || has_time(columns);
  if (has_clock && has_motion(columns)) return;
  const std::string of_light =
      "; a curve needs one voltage and one current, a scan of light u_m, v_m and irradiance_W_m2";
  std::string found = "no time among ",
              expected =
                  counts ? "frames per second beside the frames: --rate-Hz 30"
                         : "a time with its unit, such as t_s or \"Time (ms)\", or the rows per "
                           "second: --rate-Hz 100" +
                               of_light;
  const auto shared = [](const GuessedColumn& c) { return !c.shared.empty(); };
  const auto first = std::ranges::find_if(columns, shared);
  if (has_clock && first != columns.end()) {
    found = "several columns that may be " + first->shared + ": ";
    size_t place = 0;
    const std::string names = joined_text(columns, ",", [&](const GuessedColumn& c) {
      ++place;
      return &c == &*first        ? c.shared
             : !c.channel.empty() ? c.channel
                                  : "column_" + std::to_string(place);
    });
    expected = "one body, with one of them; " + command_with_names(path, names);
  } else if (!has_motion(columns)) {
    found = has_clock ? "no angle, rate or coordinate among " : "neither motion nor a curve among ";
    expected = (has_clock ? "" : "a time (t_s) and ") +
               std::string(
                   "a quantity with its unit, such as \"angle (deg)\", rate_rpm, "
                   "gyro_x_rad_s, or x_m and y_m") +
               of_light;
  }
  // Counts of an encoder, or of another instrument.
  const auto in_counts = std::ranges::find_if(columns, [](const GuessedColumn& c) {
    const auto unit = read_header_cell(c.in_file).unit;
    return unit && unit->dimension == "angle" && unit->suffix.empty();
  });
  if (!has_motion(columns) && in_counts != columns.end()) {
    throw InputError({path.string()}, in_counts->in_file, "counts", counts_of_encoder);
  }
  const bool is_one_body = expected.find("--columns") != std::string::npos;
  const std::string command =
      is_one_body || counts ? "" : command_for_columns(path, reading, columns);
  throw InputError({path.string()}, "header", found + names_in(path, reading),
                   expected + (command.empty() ? "" : "; or " + command));
}

void require_rows(const fs::path& path, const std::vector<GuessedColumn>& columns,
                  const Recording& recording) {
  if (recording.rows() >= fewest_readings) return;
  const auto first =
      std::ranges::find_if(columns, [](const GuessedColumn& c) { return has_motion({c}); });
  throw InputError({path.string()}, first->in_file,
                   std::to_string(recording.rows()) + " rows with a time",
                   "at least " + std::to_string(fewest_readings) +
                       " readings, of which some test the result: more frames per second, or a "
                       "longer recording");
}

// Adds the spring that pulls back a coordinate that oscillates. A fit that starts without a spring
// does not find the frequency of many periods.
void add_spring(TomlDocument& document, const Machine& m) {
  constexpr int x = vector_channels + static_cast<int>(Scalar::position_x);
  const std::optional<Oscillation> found = oscillation_of(
      m.recordings.front(),
      {reading_level(m.runs, x).value_or(0.0), reading_level(m.runs, x + 1).value_or(0.0)});
  if (!found) return;
  const double stiffness_N_m = std::pow(2.0 * pi / found->period_s, 2);
  const Eigen::Vector2d pull_N = stiffness_N_m * found->middle_m;
  const double largest_N = rounded(pull_N.cwiseAbs().maxCoeff() + stiffness_N_m * found->most_m);
  document.comment("CONFIRM: the place oscillates with a period of " + digits(found->period_s) +
                   " s as on a spring, which is therefore assumed.");
  SettingsNode::Table& table = document.append("disturbance");
  document.set(table, "kind", {"sliding_spring"});
  document.set(table, "stiffness_N_per_m",
               {SettingsNode::Table{{"value", number_node(stiffness_N_m)},
                                    {"sigma", number_node(stiffness_N_m)}}});
  document.set(table, "pull_N.value",
               {SettingsNode::Array{{rounded(pull_N.x())}, {rounded(pull_N.y())}}});
  document.set(table, "pull_N.sigma", {SettingsNode::Array{{largest_N}, {largest_N}}});
}

// Adds the sequence of roll, pitch and yaw.
void add_sequence(TomlDocument& document, const Machine& m) {
  if (m.platform.turns_about_one_axis() || !m.has_all({"roll_rad", "pitch_rad", "yaw_rad"}) ||
      m.has("q_w")) {
    return;
  }
  const std::string sequence = m.angles ? m.angles->sequence : std::string(angle_sequences[0]);
  SettingsNode::Table& table = document.table("recording");
  document.comment(
      !m.angles
          ? "CONFIRM: the sequence of roll, pitch and yaw; no rates are there to test it."
          : "With this sequence, " + formula_of(sequence) + ", the rates integrate to the angles.");
  document.set(table, "angle_sequence", {sequence});
}

// Adds the centre of the circle on which the coordinates are.
void add_pivot(TomlDocument& document, const Circle& circle) {
  document.comment(
      "CONFIRM: the places are on a circle of radius " + digits(circle.radius_m) + " m, to " +
      digits(100.0 * circle.scatter, 2) +
      " %, as of a pendulum or a turntable: they are read as the angle about its centre.");
  const Eigen::Vector2d& centre_m = circle.centre_m;
  document.set(document.table("recording"), "pivot_m",
               {SettingsNode::Array{{rounded(centre_m.x())}, {rounded(centre_m.y())}}});
}

// Adds the noise of every instrument, and the bias of a gyro if nothing measures the angle.
void add_noises(TomlDocument& document, const Machine& m) {
  const char *const rate_noise = "gyro.noise_rad_s", *const angle_noise = "angle.noise_arcsec";
  const bool has_gyro = m.runs.front().has_gyro, has_angle = m.runs.front().has_some_attitude();
  if (has_gyro) add_noise(document, m.runs, {3, 4, 5}, rate_noise, 1.0);
  if (has_angle && m.platform.turns_about_one_axis()) {
    add_noise(document, m.runs, {0, 1, 2}, angle_noise, arcsecond_rad);
  }
  if (has_gyro && !has_angle && m.platform.turns_about_one_axis() && !m.platform.slides()) {
    add_gyro_bias(document, m);
  }
  std::vector<int> rates, angles;
  for (int channel = vector_channels; channel < channel_count; ++channel) {
    if (channel_traits(channel).measures == Measures::angle) angles.push_back(channel);
    if (channel_traits(channel).measures == Measures::rate) rates.push_back(channel);
  }
  if (!has_gyro) add_noise(document, m.runs, rates, rate_noise, 1.0);
  if (!has_angle) add_noise(document, m.runs, angles, angle_noise, arcsecond_rad);
  if (m.platform.slides()) {
    const int x = vector_channels + static_cast<int>(Scalar::position_x);
    add_noise(document, m.runs, {x, x + 1}, "position.noise_m", 1.0);
  }
}

}  // namespace

void guess_motion(TomlDocument& document, const std::vector<fs::path>& recordings,
                  const RecordingOptions& reading) {
  std::vector<GuessedColumn> columns =
      without_computed_velocity(guess_columns(recordings.front(), reading));
  require_motion(recordings.front(), columns, reading);
  Machine m;
  std::optional<Circle> circle;
  const auto read_all = [&] {
    m.recordings.clear();
    RecordingOptions options = options_of(columns, reading);
    if (circle) options.pivot_m = {rounded(circle->centre_m.x()), rounded(circle->centre_m.y())};
    for (const fs::path& path : recordings) {
      m.recordings.push_back(read_recording(path, options));
      require_rows(path, columns, m.recordings.back());
    }
  };
  for (const fs::path& path : recordings) m.names.push_back(path.string());
  read_all();
  circle = circle_of(m.recordings.front());
  if (circle) {
    // An angle beside coordinates on a circle was computed from them, about any origin.
    std::erase_if(columns, [](const GuessedColumn& c) { return c.channel.starts_with("angle_"); });
    read_all();
  }
  infer_machine(m);
  if (m.rate_from) {
    columns = with_rate_from(std::move(columns), *m.rate_from);
    read_all();
    m.observe_as(Topology::one_axis, m.platform.axis);
  }
  add_reading(document, reading);
  add_columns(document, columns);
  if (circle) add_pivot(document, *circle);
  add_sequence(document, m);
  SettingsNode::Table& platform = add_machine(document, m);
  if (m.platform.topology == Topology::free) add_inertia(document, platform, m.runs);
  if (m.platform.slides()) add_spring(document, m);
  add_noises(document, m);
  const std::string unused =
      joined_text(MotionColumns(m.recordings.front(), m.platform, m.names.front()).unused(), ", ");
  if (!unused.empty()) document.comment("Unused columns: " + unused + ".");
}

}  // namespace photorque
