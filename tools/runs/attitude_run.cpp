#include "tools/runs/attitude_run.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "raytrace/tracing/shadow.h"
#include "scenes/experiment/named_files.h"
#include "scenes/gltf/reader.h"

namespace photorque {
namespace {

// Tables that optical commands read from the file.
constexpr const char* optical_tables[] = {"scene", "material",   "source", "receiver", "attitude",
                                          "trace", "torque_map", "camera", "effect"};

// Collects the files that strings of the experiment name, relative to its folder.
void collect_files(const SettingsNode& root, const std::filesystem::path& folder,
                   std::vector<std::filesystem::path>& files) {
  for_each_node(root, [&](const SettingsNode& node) {
    const auto* text = std::get_if<std::string>(&node.value);
    if (text == nullptr) return;
    std::filesystem::path path = named_file(folder, *text);
    if (!path.empty()) files.push_back(std::move(path));
  });
}

bool is_optical(const std::string& key) {
  return std::find(std::begin(optical_tables), std::end(optical_tables), key) !=
         std::end(optical_tables);
}

// Values below `rounding` are rounding errors of zero.
std::string brief(double value, double rounding) {
  if (std::isnan(value)) return "-";
  return printed("%.3g", std::abs(value) > rounding ? value : 0.0);
}

// Minimum height above a marker at which its light starts, for models without thickness.
constexpr double least_height_m = 1e-4;

bool is_shaded(const TraceableScene& scene, const Marker& marker, const Vec3& camera_body_m) {
  const double height_m = std::max(least_height_m, shadow_ray_offset_m(scene));
  const Vec3 start_m = marker.position_body_m + height_m * marker.normal_body;
  const Vec3 way_m = camera_body_m - start_m;
  const double length_m = way_m.norm();
  ShadowRay ray{};
  for (int k = 0; k < 3; ++k) {
    ray.origin_m[k] = static_cast<float>(start_m[k] - scene_centre_m(scene)[k]);
    ray.direction[k] = static_cast<float>(way_m[k] / length_m);
  }
  ray.length_m = static_cast<float>(length_m);
  uint8_t lit = 1;
  find_shadows(scene, {&ray, 1}, {&lit, 1});
  return lit == 0;
}

std::string vector_override(size_t disturbance, const Vec3& v) {
  return printed("disturbance[%zu].sun_direction=[%.17g,%.17g,%.17g]", disturbance, v.x(), v.y(),
                 v.z());
}

// Also false for a kind that is not a text; the reader of the table reports this error.
bool is_of_kind(const Settings& table, const std::string& kind) {
  if (!table.has("kind")) return false;
  const auto* name = std::get_if<std::string>(&table.raw("kind").value);
  return name != nullptr && *name == kind;
}

std::optional<Vec3> direction_of_sun_source(const ExperimentFile& file) {
  std::optional<Vec3> to_sun;
  if (!file.scene_file) return to_sun;
  for (const Settings& source : file.sources) {
    if (is_of_kind(source, "sun") && source.has("direction")) {
      to_sun = -source.vector3("direction").normalized();
    }
  }
  return to_sun;
}

// Overrides that give an orbit the direction of the sun of [[source]], and planet_light that of the
// orbit. Throws InputError if both state different directions.
std::vector<std::string> orbit_overrides(const ExperimentFile& file) {
  std::optional<Vec3> to_sun = direction_of_sun_source(file);
  const std::vector<Settings> disturbances = file.others("disturbance");
  std::vector<std::string> overrides;
  bool in_orbit = false;
  for (size_t i = 0; i < disturbances.size(); ++i) {
    const Settings& orbit = disturbances[i];
    if (!is_of_kind(orbit, "orbit")) continue;
    in_orbit = true;
    if (!orbit.has("sun_direction")) {
      if (to_sun) overrides.push_back(vector_override(i, *to_sun));
      continue;
    }
    const Vec3 named = orbit.vector3("sun_direction").normalized();
    constexpr double alike_rad = 0.1 * degree_rad;
    if (to_sun && std::atan2(named.cross(*to_sun).norm(), named.dot(*to_sun)) > alike_rad) {
      throw orbit.error("sun_direction", "a direction away from that of [[source]] \"sun\"",
                        "the opposite of its `direction`, or nothing");
    }
    to_sun = named;
  }
  for (size_t i = 0; i < disturbances.size(); ++i) {
    const Settings& planet = disturbances[i];
    const bool is_drag = is_of_kind(planet, "aerodynamic_drag");
    if (!is_drag && !is_of_kind(planet, "planet_light")) continue;
    if (!in_orbit) {
      throw planet.error("kind", in_quotes(planet.text("kind")) + " of a platform on the ground",
                         "a disturbance \"orbit\" beside it");
    }
    if (!is_drag && !planet.has("sun_direction") && to_sun)
      overrides.push_back(vector_override(i, *to_sun));
  }
  return overrides;
}

ExperimentFile read_with_overrides(const RunOptions& options) {
  std::vector<std::string> all = options.overrides;
  const auto read = [&] {
    return read_experiment_text(options.experiment, options.experiment_text(), all);
  };
  for (const std::string& one : orbit_overrides(read())) all.push_back(one);
  return read();
}

}  // namespace

AttitudeExperiment::AttitudeExperiment(const RunOptions& options)
    : file_(read_with_overrides(options)) {
  const Settings& root = file_.settings;
  for (const char* table : optical_tables) {
    if (root.has(table)) root.raw(table);
  }
  root.finish();
  std::vector<std::filesystem::path> files;
  for (const std::string& key : root.keys()) {
    if (!is_optical(key)) collect_files(root.raw(key), options.experiment.parent_path(), files);
  }
  for (const std::filesystem::path& file : files) add_input(file);
}

void AttitudeExperiment::add_input(const std::filesystem::path& path) {
  file_.inputs.emplace_back(path.filename().string(), content_hash(read_file(path)));
}

Provenance AttitudeExperiment::provenance(uint64_t seed) const {
  Provenance provenance = build_provenance();
  provenance.seed = seed;
  provenance.inputs = file_.inputs;
  return provenance;
}

std::vector<std::pair<std::string, std::string>> look_through_scene(const ExperimentFile& file,
                                                                    Sensors& sensors) {
  if (!file.scene_file || !sensors.camera || !sensors.camera->geometry) return {};
  GltfModel model = read_gltf(*file.scene_file, {.bands = file.bands,
                                                 .metres_per_unit = file.metres_per_unit,
                                                 .origin_m = file.centre_of_rotation_m,
                                                 .may_leave_folder = file.may_leave_folder});
  const auto scene = std::make_shared<const TraceableScene>(std::move(model.scene));
  TrackingCamera& camera = *sensors.camera->geometry;
  camera.is_hidden = [scene, markers = camera.markers,
                      camera_m = camera.lab_from_camera.translation_m](size_t marker,
                                                                       const Quat& lab_from_body) {
    return is_shaded(*scene, markers[marker], lab_from_body.conjugate() * camera_m);
  };
  return model.inputs;
}

void print_table(const Console& console, const Table& table,
                 const std::vector<PrintedColumn>& columns, size_t most_rows) {
  std::vector<std::vector<std::string>> cells;
  std::vector<bool> is_text;
  for (const PrintedColumn& wanted : columns) {
    const Table::Column* const column = table.find(wanted.name);
    if (column == nullptr) continue;
    std::vector<std::string> texts = {wanted.title};
    is_text.push_back(!column->texts.empty());
    texts.insert(texts.end(), column->texts.begin(), column->texts.end());
    double largest = 0.0;
    for (const double value : column->values) {
      if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
    }
    for (const double value : column->values) texts.push_back(brief(value, 1e-14 * largest));
    cells.push_back(std::move(texts));
  }
  if (cells.empty()) return;
  for (size_t row = 0; row < cells.front().size(); ++row) {
    std::string line;
    for (size_t c = 0; c < cells.size(); ++c) {
      size_t width = 0;
      for (const std::string& cell : cells[c]) width = std::max(width, letters_of(cell));
      const std::string space(width - letters_of(cells[c][row]), ' ');
      line += "  " + (is_text[c] ? cells[c][row] + space : space + cells[c][row]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    (row <= most_rows ? console : console.details()).line(line);
  }
}

void print_reasons(const Console& console, const Table& figures) {
  const auto& quantity = figures.column("quantity").texts;
  const auto& why = figures.column("why").texts;
  console.heading("Why");
  for (size_t i = 0; i < quantity.size(); ++i) console.line("  " + quantity[i] + ": " + why[i]);
}

}  // namespace photorque
