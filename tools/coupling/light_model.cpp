#include "tools/coupling/light_model.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>

#include "core/constants.h"
#include "core/errors.h"
#include "core/parallel.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "tools/coupling/table_cache.h"

namespace photorque {

bool has_light(const ExperimentFile& file) {
  return file.scene_file && !file.sources.empty() && file.settings.has("platform");
}

namespace {

// Whether a lamp belongs to a source: its name is NAME or NAME[0], NAME[1], …
bool is_of(const Beam& beam, const std::string& source) {
  return beam.name == source || beam.name.starts_with(source + "[");
}

bool is_sun(const Beam& beam) {
  return beam.aperture && std::isinf(beam.aperture->radius_m);
}

Vec3 towards(const Beam& beam) {
  return -beam.lab_from_emitter.direction(Vec3::UnitZ());
}

std::set<std::string> switched_sources(const LightSettings& settings) {
  std::set<std::string> names;
  for (const LightSettings::Switch& one : settings.switches) {
    if (!one.source.empty()) names.insert(one.source);
  }
  return names;
}

InputError unknown_source(const ExperimentFile& file, const std::string& name,
                          const std::vector<Beam>& beams) {
  std::set<std::string> known;
  for (const Beam& beam : beams) known.insert(beam.name.substr(0, beam.name.find('[')));
  return InputError({file.path.string()}, "light.switch.source", "\"" + name + "\"",
                    "the name of a source: " + listed_names(known, name));
}

std::optional<Vec3> direction_of_suns(const std::vector<Beam>& beams) {
  if (beams.empty()) return {};
  for (const Beam& beam : beams) {
    if (!is_sun(beam) || towards(beam).dot(towards(beams.front())) < 1.0 - 1e-12) return {};
  }
  return towards(beams.front());
}

}  // namespace

LightModel::~LightModel() = default;

LightModel::LightModel(const RunOptions& options, const Console& console,
                       const LightSettings& settings, const Platform& platform)
    : settings_(settings), threads_(options.threads), options_(options) {
  options_.seed.reset();  // the seed belongs to the instruments
  // For a table, many attitudes are traced in parallel, each with one thread; this uses the
  // processors better than one trace with many threads.
  if (settings.mode == LightSettings::Mode::table) options_.threads = 1;
  auto whole = std::make_unique<OpticalRun>(options_, console);
  const std::vector<Beam> beams = whole->experiment().beams;
  const ExperimentFile file = whole->experiment().file;
  inputs_ = whole->experiment().inputs;
  sun_direction_lab_ = direction_of_suns(beams);
  if (sun_direction_lab_) {
    sun_angle_rad_ = std::acos(std::clamp(sun_direction_lab_->z(), -1.0, 1.0));
  }
  max_angle_rad_ = std::min(pi, platform.tilt_limit_rad.value_or(pi) + sun_angle_rad_);
  for (const std::string& name : switched_sources(settings)) {
    if (std::ranges::none_of(beams, [&](const Beam& beam) { return is_of(beam, name); })) {
      throw unknown_source(file, name, beams);
    }
  }
  find_joint(file);
  std::vector<std::string> names;
  for (const Beam& beam : beams) {
    if (std::ranges::find(names, group_of(beam)) == names.end()) names.push_back(group_of(beam));
  }
  key_ = content_key(file);
  const size_t positions = positions_ ? positions_->angles_rad().size() : 1;
  for (const std::string& name : names) {
    for (size_t position = 0; position < positions; ++position) {
      std::optional<double> joint_rad;
      if (positions_) joint_rad = positions_->angles_rad()[position];
      const bool alone = names.size() == 1 && !joint_rad;
      lights_.push_back(make_light(alone ? std::move(whole) : nullptr, name, joint_rad));
      Group group{.name = name, .position = position};
      for (const Beam& beam : lights_.back().run->experiment().beams) {
        group.is_sun = is_sun(beam);
        if (!group.is_sun) group.emitted_W += beam.emitter->power_W();
      }
      groups_.push_back(group);
    }
  }
  if (lights_.front().array) {
    const Light& first = lights_.front();
    const ArrayPower& array = *first.array;
    for (const std::string& notice : array.notices) console.line("note: " + notice);
    array_ = array.design;
    day_ = array.report.day;
    if (array.report.motion) tracker_ = array.report.motion->trackers.front();
    const FluxMapReceiver& map = first.run->flux_map(array.flux_map);
    BinSums dark{map.bins(), 1, std::vector<double>(map.bins(), 0.0)};
    cell_area_m2_ =
        cell_currents(array.design, array_light(map, dark), array.responsivity_A_W).area_m2;
  }
  for (size_t g = 0; g < groups_.size(); ++g) groups_[g].first = g * channels_per_group();
}

double LightModel::first_angle_rad(double initial_tilt_rad, bool is_live) const {
  constexpr double least_rad = 5.0 * degree_rad, margin = 1.2;
  const bool asks_once = is_live || sun_direction_lab_.has_value();
  double tilt_rad = asks_once ? max_angle_rad_ : std::max(least_rad, 2.0 * initial_tilt_rad);
  if (settings_.max_tilt_rad)
    tilt_rad = std::max(*settings_.max_tilt_rad, margin * initial_tilt_rad);
  return std::min(max_angle_rad_, tilt_rad + sun_angle_rad_);
}

// Finds the moving joint; at most one is allowed.
void LightModel::find_joint(const ExperimentFile& file) {
  for (size_t j = 0; j < file.joints.size(); ++j) {
    const Joint& joint = file.joints[j];
    if (!joint.moves()) continue;
    if (joint_) {
      throw file.joint_tables[j].error("", "a second joint that moves",
                                       "one (parts that turn together are its nodes)");
    }
    if (joint.towards_sun && !sun_direction_lab_) {
      throw file.joint_tables[j].error("towards_sun", "light that is not of one Sun alone",
                                       "one [[source]] of kind \"sun\"");
    }
    joint_ = joint;
    joint_number_ = j;
    if (!joint.towards_sun) positions_.emplace(joint);
  }
}

// Name of a lamp's group. Suns are separate from lamps, because the planet's shadow affects only
// them.
std::string LightModel::group_of(const Beam& beam) const {
  for (const std::string& name : switched_sources(settings_)) {
    if (is_of(beam, name)) return name;
  }
  return is_sun(beam) ? "sun" : "light";
}

// `run`: an existing run, or null.
LightModel::Light LightModel::make_light(std::unique_ptr<OpticalRun> run, const std::string& group,
                                         std::optional<double> joint_rad) const {
  Light light{std::move(run), {}};
  if (!light.run) {
    RunOptions posed = options_;
    if (joint_rad) {
      posed.overrides.push_back(printed("joint[%zu].angle_rad=%.17g", joint_number_, *joint_rad));
    }
    light.run = std::make_unique<OpticalRun>(posed, Console());
  }
  light.run->keep_beams([&](const Beam& beam) { return group_of(beam) == group; });
  if (!light.run->experiment().file.others("array").empty()) {
    const auto rest = std::ranges::find(groups_, group, &Group::name);
    const auto same = static_cast<size_t>(rest - groups_.begin());
    light.array =
        read_array_power(*light.run, rest == groups_.end() ? nullptr : &*lights_[same].array);
  }
  return light;
}

double LightModel::weight(const Group& group, double time_s) const {
  if (!positions_) return 1.0;
  return positions_->weights(joint_->angle_at(time_s))[group.position];
}

std::vector<double> LightModel::corners_s() const {
  std::vector<double> corners;
  if (positions_) {
    for (const Joint::Instant& instant : joint_->schedule) corners.push_back(instant.time_s);
  }
  return corners;
}

RotationSample LightModel::trace(const Quat& lab_from_body) const {
  RotationSample sample;
  for (size_t g = 0; g < groups_.size(); ++g) {
    if (joint_ && joint_->towards_sun) {
      const double angle_rad =
          joint_->angle_towards(lab_from_body.conjugate() * *sun_direction_lab_);
      add(make_light(nullptr, groups_[g].name, angle_rad), lab_from_body, sample);
    } else {
      add(lights_[g], lab_from_body, sample);
    }
  }
  return sample;
}

// Appends the channels of one group to the sample.
void LightModel::add(const Light& light, const Quat& lab_from_body, RotationSample& sample) const {
  const auto put = [&](double value, double error) {
    sample.value.push_back(value);
    sample.error.push_back(error);
  };
  const OpticalRun& run = *light.run;
  const OpticalResult result = run.run({lab_from_body, Vec3::Zero()}, {}, settings_.rays);
  const WrenchEstimate wrench = run.wrench_of(result);
  const Vec3 torque_error = wrench.torque_error_N_m(), force_error = wrench.force_error_N();
  for (int k = 0; k < 3; ++k) put(wrench.mean.torque_N_m[k], torque_error[k]);
  for (int k = 0; k < 3; ++k) put(wrench.mean.force_N[k], force_error[k]);
  if (!light.array) return;
  const ArrayPower& array = *light.array;
  const CellCurrents cells =
      cell_currents(array.design, light_on(array, run, result.sums), array.responsivity_A_W);
  for (size_t i = 0; i < cells.photocurrent_A.size(); ++i) {
    put(cells.photocurrent_A[i], cells.photocurrent_error_A[i]);
  }
  put(cells.power_on_cells_W.value, cells.power_on_cells_W.standard_error);
}

std::string LightModel::content_key(const ExperimentFile& file) const {
  std::string text = table_cache_version();
  for (const char* table : {"scene", "material", "source", "receiver", "joint", "trace"}) {
    if (file.settings.has(table))
      text += std::string(table) + canonical_text(file.settings.raw(table));
  }
  if (file.settings.has("array")) {
    // Keys that act after the cells do not change the light.
    text += "array" + canonical_text(file.settings.raw("array"),
                                     {"day", "thermal", "tracker", "target", "layout", "chain"});
  }
  for (const auto& [name, hash] : inputs_) {
    if (name != file.path.filename().string() && !name.starts_with("--set ")) text += hash;
  }
  for (const std::string& name : switched_sources(settings_)) text += "group " + name;
  return text + printed("%.17g %llu %zu", settings_.tolerance,
                        static_cast<unsigned long long>(settings_.rays), settings_.max_traces);
}

std::shared_ptr<const RotationTable> LightModel::make_table(const Console& console,
                                                            double max_angle_rad) const {
  auto table = std::make_shared<RotationTable>();
  const std::string key = content_hash(key_ + printed(" angle %.17g", max_angle_rad));
  const std::string what =
      "light over attitude" + (max_angle_rad < pi
                                   ? ", up to " + show(max_angle_rad / degree_rad) + " deg of tilt"
                                   : std::string());
  if (settings_.cache && read_cached_table(*settings_.cache, key, *table)) {
    console.line(what + ": " + std::to_string(table->samples() * table->twists()) +
                 " attitudes, stored by an earlier run");
    return table;
  }
  RotationTableOptions options;
  if (sun_direction_lab_) {
    options.axis_from_lab = rotation_between(*sun_direction_lab_, Vec3::UnitZ());
  }
  options.max_angle_rad = max_angle_rad;
  options.tolerance = settings_.tolerance;
  options.max_samples = settings_.max_traces;
  for (size_t g = 0; g < groups_.size(); ++g) {
    for (size_t c = 0; c < channels_per_group(); ++c) {
      const int kind = c < 3 ? 0 : c < 6 ? 1 : c + 1 < channels_per_group() ? 2 : 3;
      options.group_of_channel.push_back(kind);
    }
  }
  const WallTime wall;
  std::atomic<size_t> traced = 0;
  std::string stage;
  const auto trace_all = [&](std::span<const Quat> attitudes) {
    std::vector<RotationSample> samples(attitudes.size());
    const auto bar = console.progress("light over attitude, " + stage);
    const size_t before = traced;
    parallel_for(attitudes.size(), threads_, [&](size_t i) {
      samples[i] = trace(attitudes[i]);
      const size_t done = ++traced - before;
      if (bar) bar(static_cast<double>(done) / static_cast<double>(attitudes.size()));
      console.note_progress("light over attitude, " + stage + ": " + std::to_string(before + done) +
                            " attitudes traced, " + std::to_string(attitudes.size() - done) +
                            " to go");
    });
    return samples;
  };
  *table = make_rotation_table(trace_all, options,
                               [&](size_t, const std::string& what) { stage = what; });
  console.done();
  console.line(what + ": " + std::to_string(traced) + " attitudes traced in " +
               show(std::round(10 * wall.elapsed_s()) / 10) + " s");
  if (settings_.cache && !write_cached_table(*settings_.cache, key, *table)) {
    console.line("note: the table could not be stored in " + settings_.cache->string());
  }
  return table;
}

}  // namespace photorque
