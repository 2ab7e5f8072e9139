// First step of reading an experiment: the text, without the scene.
#include <cmath>

#include "core/constants.h"
#include "core/files.h"
#include "core/provenance.h"
#include "core/text/parse.h"
#include "scenes/experiment/experiment.h"
#include "scenes/experiment/keys.h"
#include "scenes/experiment/toml.h"
#include "scenes/experiment/uncertain.h"

namespace photorque {
namespace {

// Tables that this reader ignores; the programs that use them check them.
constexpr const char* tables_of_others[] = {
    "array",     "sweep",     "platform",     "environment",  "disturbance", "sensors",
    "recording", "published", "propagate",    "budget",       "balance",     "light",
    "effect",    "serve",     "supply_trade", "camera_study", "estimate"};

void require_ascending(const Settings& settings, std::string_view key,
                       const std::vector<double>& values) {
  if (values.empty()) throw settings.error(key, "an empty array", "at least one number");
  for (size_t i = 1; i < values.size(); ++i) {
    if (values[i] <= values[i - 1]) {
      throw settings.error(key, "a number that is not above the one before it",
                           "numbers in rising order");
    }
  }
}

Bands read_bands(const Settings& scene) {
  Bands bands;
  if (!scene.has(scene_key::bands)) return bands;
  bands.edges_m = scene.get(scene_key::bands);
  require_ascending(scene, scene_key::bands, bands.edges_m);
  if (bands.count() < 1 || bands.count() > max_bands) {
    throw scene.error(scene_key::bands, std::to_string(bands.edges_m.size()) + " edges",
                      "from 2 to " + std::to_string(max_bands + 1) + " edges");
  }
  return bands;
}

Attitude read_attitude(const Settings& root) {
  Attitude attitude;
  if (!root.has(attitude_key::attitude)) return attitude;
  const Settings table = root.get(attitude_key::attitude);
  attitude.tilt_rad = table.get(attitude_key::tilt);
  attitude.heading_rad = table.get(attitude_key::heading);
  return attitude;
}

TraceOptions read_trace_options(const Settings& root) {
  TraceOptions options;
  if (!root.has(trace_key::trace)) return options;
  const Settings table = root.get(trace_key::trace);
  const auto count = [&](const IntegerKey& key, auto otherwise) {
    return static_cast<decltype(otherwise)>(table.get_or(key, static_cast<int64_t>(otherwise)));
  };
  options.rays = count(trace_key::rays, options.rays);
  options.replicates = count(trace_key::replicates, options.replicates);
  options.seed = count(trace_key::seed, options.seed);
  options.max_depth = count(trace_key::max_depth, options.max_depth);
  options.cutoff = table.get_or(trace_key::cutoff, options.cutoff);
  return options;
}

TraceEffort read_effort(const Settings& root) {
  TraceEffort effort;
  if (!root.has(trace_key::trace)) return effort;
  const Settings table = root.get(trace_key::trace);
  constexpr TraceEffort::Direct ways[] = {TraceEffort::Direct::automatic,
                                          TraceEffort::Direct::gather, TraceEffort::Direct::rays};
  effort.direct = ways[table.get(trace_key::direct)];
  if (table.has(trace_key::target_error)) effort.target_error = table.get(trace_key::target_error);
  if (table.has(trace_key::max_time)) effort.max_time_s = table.get(trace_key::max_time);
  if (table.has(trace_key::arriving_rays)) {
    effort.arriving_rays = static_cast<uint64_t>(table.get(trace_key::arriving_rays));
  }
  if (effort.max_time_s && !effort.target_error) {
    throw table.error(trace_key::max_time, "a limit without a target",
                      "also target_error: only then are rays added");
  }
  return effort;
}

// The default grid: tilts up to 30 deg in all directions.
AttitudeGrid usual_torque_map() {
  AttitudeGrid grid;
  for (int tilt = 0; tilt <= 30; tilt += 10) grid.tilt_rad.push_back(tilt * degree_rad);
  for (int heading = 0; heading < 360; heading += 45) {
    grid.heading_rad.push_back(heading * degree_rad);
  }
  return grid;
}

// An axis of directions: its array in degrees, or equal steps from −half to
// half.
std::vector<double> read_direction_axis(const Settings& table, const NumbersKey& array,
                                        const NumberKey& step) {
  const double half_rad = array.range.high;
  if (table.has(array)) {
    const std::vector<double> values = table.get(array);
    require_ascending(table, array, values);
    if (table.has(step))
      throw table.error(step, "a step beside " + std::string(array.name), "one of the two");
    return values;
  }
  const double step_rad = table.get(step);
  const double steps = 2.0 * half_rad / step_rad;
  const double whole = std::round(steps);
  if (std::abs(steps - whole) > 1e-9 * whole || whole > 3600.0) {
    throw table.error(step, std::to_string(step_rad / degree_rad),
                      "a whole fraction of " +
                          std::to_string(std::lround(2.0 * half_rad / degree_rad)) +
                          ", at least 0.1");
  }
  std::vector<double> values;
  const auto count = static_cast<size_t>(whole);
  for (size_t i = 0; i <= count; ++i) {
    values.push_back(half_rad * (2.0 * static_cast<double>(i) / whole - 1.0));
  }
  return values;
}

std::optional<Settings> read_molecular_flow(const Settings& root, const Settings& table,
                                            bool over_directions) {
  if (!table.has(torque_map_key::molecular_flow)) return std::nullopt;
  if (!over_directions) {
    throw table.error(torque_map_key::molecular_flow, "a gas flow without directions",
                      "also azimuths and elevations");
  }
  if (root.has("source")) {
    throw root.error("source", "a source beside torque_map.molecular_flow", "one of the two");
  }
  return table.get(torque_map_key::molecular_flow);
}

std::optional<DirectionGrid> read_light_directions(const Settings& table) {
  using namespace torque_map_key;
  if (!table.has(azimuth) && !table.has(azimuth_step) && !table.has(elevation) &&
      !table.has(elevation_step)) {
    return std::nullopt;
  }
  for (const NumbersKey& key : {tilt, heading}) {
    if (table.has(key)) {
      throw table.error(key, "an attitude beside directions of light",
                        "tilts and headings, or elevations and azimuths");
    }
  }
  return DirectionGrid{read_direction_axis(table, elevation, elevation_step),
                       read_direction_axis(table, azimuth, azimuth_step)};
}

void read_torque_map(const Settings& root, ExperimentFile& file) {
  if (!root.has(torque_map_key::torque_map)) {
    file.torque_map = usual_torque_map();
    return;
  }
  file.torque_map = {{file.attitude.tilt_rad}, {file.attitude.heading_rad}};
  const Settings table = root.get(torque_map_key::torque_map);
  const auto read = [&](const NumbersKey& key, std::vector<double>& angles_rad) {
    if (!table.has(key)) return;
    angles_rad = table.get(key);
    require_ascending(table, key, angles_rad);
  };
  read(torque_map_key::tilt, file.torque_map.tilt_rad);
  read(torque_map_key::heading, file.torque_map.heading_rad);
  file.light_directions = read_light_directions(table);
  if (table.has(torque_map_key::rays)) {
    file.torque_map_rays = static_cast<uint64_t>(table.get(torque_map_key::rays));
  }
  file.molecular_flow = read_molecular_flow(root, table, file.light_directions.has_value());
}

// Reports a misspelt file name before unknown keys for this type of
// file.
void require_model(const Settings& scene, const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    if (!scene.has("unit") && !scene.has(scene_key::up)) return;  // its reader reports it
    throw scene.error(scene_key::file, "no file " + file.string(),
                      "a model (glTF, GLB, STL or OBJ)");
  }
  const std::string ending = lower_case(file.extension().string());
  if (ending == ".gltf" || ending == ".glb") return;
  throw scene.error(scene_key::file, "\"" + file.filename().string() + "\"",
                    "a model that ends in .gltf, .glb, .stl or .obj");
}

// Unit and axis of an STL or OBJ file; empty for glTF, which defines both.
std::optional<CadConventions> read_cad_conventions(const Settings& scene,
                                                   const std::filesystem::path& file) {
  if (!cad_format(file)) {
    require_model(scene, file);
    for (const char* key : {"unit", "up"}) {
      if (!scene.has(key)) continue;
      throw scene.error(
          key, "a glTF file",
          "an STL or OBJ file (glTF is in metres with y up; metres_per_unit scales it)");
    }
    return std::nullopt;
  }
  CadConventions conventions;
  if (scene.has(scene_key::metres_per_unit)) {
    if (scene.has("unit")) {
      throw scene.error(scene_key::metres_per_unit, "unit and metres_per_unit", "one of them");
    }
    conventions.metres_per_unit = scene.get(scene_key::metres_per_unit);
  } else {
    const std::vector<std::string> units = cad_units();
    conventions.metres_per_unit = metres_of_unit(units[scene.choice("unit", units)]);
  }
  conventions.y_is_up = scene.get(scene_key::up) == 1;
  return conventions;
}

}  // namespace

std::vector<Settings> ExperimentFile::others(const std::string& key) const {
  if (!settings.has(key)) return {};
  // A separate root, because the reader checks that all keys of these tables are known.
  return Settings(SettingsNode{SettingsNode::Table{{key, settings.raw(key)}}}).tables(key);
}

ExperimentFile read_experiment_file(const std::filesystem::path& path,
                                    std::span<const std::string> overrides) {
  constexpr uint64_t largest_bytes = 1ull << 26;
  return read_experiment_text(path, read_file(path, largest_bytes), overrides);
}

ExperimentFile read_experiment_text(const std::filesystem::path& path, const std::string& text,
                                    std::span<const std::string> overrides) {
  auto root = std::make_shared<SettingsNode>(parse_toml(text, path.string()));
  ExperimentFile file;
  file.path = path;
  file.inputs = {{path.filename().string(), content_hash(text)}};
  for (const std::string& assignment : overrides) {
    apply_override(*root, assignment);
    file.inputs.emplace_back("--set " + assignment, content_hash(assignment));
  }
  take_uncertainty(*root);
  file.settings = Settings(std::move(root));
  const Settings& settings = file.settings;
  if (settings.has(scene_key::scene)) {
    const Settings scene = settings.get(scene_key::scene);
    file.scene_file = path.parent_path() / scene.get(scene_key::file);
    file.cad = read_cad_conventions(scene, *file.scene_file);
    if (!file.cad) file.metres_per_unit = scene.get(scene_key::metres_per_unit);
    file.centre_of_rotation_m = scene.get(scene_key::centre_of_rotation);
    file.textures = scene.get(scene_key::textures);
    file.may_leave_folder = scene.get(scene_key::allow_outside);
    file.bands = read_bands(scene);
  }
  file.materials = settings.tables("material");
  file.sources = settings.tables("source");
  file.receivers = settings.tables("receiver");
  file.joint_tables = settings.tables("joint");
  file.joints = read_joints(file.joint_tables);
  file.attitude = read_attitude(settings);
  file.trace = read_trace_options(settings);
  file.effort = read_effort(settings);
  read_torque_map(settings, file);
  if (settings.has(camera_key::camera)) file.camera = settings.get(camera_key::camera);
  for (const char* key : tables_of_others) {
    if (settings.has(key)) settings.raw(key);
  }
  return file;
}

}  // namespace photorque
