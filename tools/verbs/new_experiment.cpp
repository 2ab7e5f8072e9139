// photorque new: a first experiment with comments, for a user's model or for a platform alone.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "receivers/surface_grid.h"
#include "scenes/cad/model.h"
#include "scenes/experiment/document.h"
#include "scenes/experiment/toml.h"
#include "scenes/gltf/reader.h"
#include "tools/verbs/check.h"
#include "tools/verbs/verb.h"

namespace photorque::verbs::new_experiment {
namespace {

namespace fs = std::filesystem;

struct Options : CommandOptions {
  std::optional<fs::path> scene;
};

void add_options(Command& command, Options& options) {
  command.add_experiment(options, Command::Folder::none);
  command.add("--scene", options.scene, "A model (glTF, GLB, STL or OBJ) to be lit");
}

constexpr const char* platform_text = R"(
# ---- The platform: for budget, propagate, balance and diagnose
[platform]
topology = "tabletop"                 # dumbbell | tabletop | hollow | free (a spacecraft)
mass_kg = 7.0                         # of everything that turns
inertia_kg_m2 = [[0.11, 0, 0], [0, 0.12, 0], [0, 0, 0.19]]   # about the centre of rotation, body axes
tilt_limit_deg = 30                   # the bearing's stop

[environment]
gravity_m_s2 = 9.80665
latitude_deg = 45.5

# One table for every torque that acts; docs/disturbances.md has them all. A number may be given with
# its uncertainty, which diagnose then fits.
[[disturbance]]
kind = "static_unbalance"
offset_m = { value = [0, 0, -1e-5], sigma = [2e-7, 2e-7, 1e-6] }   # of the centre of mass

[[disturbance]]
kind = "bearing_drag"
coefficient_N_m_s = 2e-5

[sensors.camera]
noise_arcsec = [37, 37, 12]           # about lab x, y and z
[sensors.gyro]
noise_rad_s = 2e-4

[propagate]
duration_s = 600
initial_tilt_deg = 1

[budget]                              # the state of which budget prints the torques
tilt_deg = 1
spin_rpm = 1
)";

std::string quoted(const std::string& text) {
  return toml_value({text});
}

std::string number(double value) {
  return printed("%.3g", value);
}

// Bounding box of all parts of that name, or of the whole scene.
Eigen::AlignedBox3d box_of(const Scene& scene, const std::optional<std::string>& path = {}) {
  Eigen::AlignedBox3d box;
  for (const Instance& instance : scene.instances) {
    if (path && instance.path != *path) continue;
    for (const Vec3& vertex : scene.meshes[instance.mesh].vertices_m) {
      box.extend(Vec3(instance.body_from_mesh * vertex));
    }
  }
  return box;
}

double upward_area_m2(const Scene& scene, uint32_t instance) {
  double area = 0.0;
  const std::vector<uint32_t> alone = {instance};
  for (const SurfaceFace& face : faces_of(scene, alone, Vec3::UnitZ())) {
    area += face.area_body_m2.z();
  }
  return area;
}

// Centre of the bounding box of all parts of that name.
Vec3 middle_m(const Scene& scene, const std::string& path) {
  const Eigen::AlignedBox3d box = box_of(scene, path);
  return box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.center());
}

// The part that most likely receives light from above, judged by its name, otherwise the part with
// the largest area seen from above.
std::string lit_node(const Scene& scene) {
  std::string best;
  double best_score = -1.0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const std::string& path = scene.instances[i].path;
    const auto contains = [&](const char* word) { return path.find(word) != std::string::npos; };
    const double bonus = contains("solar") || contains("cells") || contains("panel") ? 1e6 : 0.0;
    const double area_m2 = upward_area_m2(scene, i);
    const double score = area_m2 > 0.0 ? area_m2 * (1.0 + bonus) : -1.0;
    if (score > best_score) {
      best_score = score;
      best = path;
    }
  }
  return best;
}

std::string listed(const std::string& what, const std::set<std::string>& names) {
  constexpr size_t most = 40;
  std::string text = "# " + what + ":\n";
  size_t count = 0;
  for (const std::string& name : names) {
    if (++count > most) return text + "#   and " + std::to_string(names.size() - most) + " more\n";
    text += "#   " + quoted(name) + "\n";
  }
  return text;
}

// Settings needed to read a model: for STL and OBJ the unit and axis, from --set.
struct SceneWords {
  std::optional<CadConventions> cad;
  std::string unit, up;
};

SceneWords scene_words(const Options& options) {
  const std::string ending = lower_case(options.scene->extension().string());
  if (ending != ".gltf" && ending != ".glb" && !cad_format(*options.scene)) {
    throw InputError({options.scene->string()}, "", "a model \"" + ending + "\"",
                     "glTF, STL or OBJ (.gltf, .glb, .stl, .obj): others are converted to one of "
                     "them, see docs/files.md");
  }
  SceneWords words;
  if (!cad_format(*options.scene)) return words;
  SettingsNode root;
  for (const std::string& assignment : options.overrides) {
    if (assignment.starts_with("scene.")) apply_override(root, assignment);
  }
  const Settings settings(std::move(root));
  if (!settings.has("scene") || !settings.table("scene").has("unit")) {
    throw InputError({options.scene->string()}, "scene.unit", "nothing",
                     "a unit of length, because the file contains none: --set scene.unit=mm");
  }
  const Settings scene = settings.table("scene");
  const std::vector<std::string> units = cad_units(), axes = {"z", "y"};
  words.unit = units[scene.choice("unit", units)];
  words.up = axes[scene.choice_or("up", axes, 0)];
  words.cad = CadConventions{metres_of_unit(words.unit), words.up == "y"};
  return words;
}

// Assigns the line of the old value to the value that replaces it.
void keep_lines(const SettingsNode& before, SettingsNode& now) {
  if (now.where.line <= 0) now.where = before.where;
  const auto* old_table = std::get_if<SettingsNode::Table>(&before.value);
  const auto* old_items = std::get_if<SettingsNode::Array>(&before.value);
  if (auto* table = std::get_if<SettingsNode::Table>(&now.value); table && old_table) {
    for (auto& [key, item] : *table) {
      if (const auto at = old_table->find(key); at != old_table->end())
        keep_lines(at->second, item);
    }
  } else if (auto* items = std::get_if<SettingsNode::Array>(&now.value); items && old_items) {
    for (size_t i = 0; i < std::min(items->size(), old_items->size()); ++i) {
      keep_lines((*old_items)[i], (*items)[i]);
    }
  }
}

// The experiment with --set applied; its comments are kept.
std::string with_overrides(const std::string& text, const Options& options) {
  if (options.overrides.empty()) return text;
  TomlDocument document(text, options.experiment.string());
  const SettingsNode before = document.root;
  for (const std::string& one : options.overrides) apply_override(document.root, one);
  if (same_values(before, document.root)) return text;
  keep_lines(before, document.root);
  return document.text();
}

// Size of the model as text: it reveals a wrong unit.
std::string size_text(const Scene& scene, const fs::path& file, const SceneWords& words) {
  const Eigen::AlignedBox3d box = box_of(scene);
  if (box.isEmpty()) return "";
  const Vec3 size_m = box.sizes();
  return "Size of " + file.filename().string() + ": " + number(size_m.x()) + " × " +
         number(size_m.y()) + " × " + number(size_m.z()) + " m along body x, y and z, with " +
         (words.cad ? "scene.unit = \"" + words.unit + "\"" : "metres in the file");
}

std::string scene_text(const SceneWords& words) {
  if (!words.cad) {
    return "   # metres, +Y up: glTF (x, y, z) is body (x, -z, y), its origin the centre of "
           "rotation\n# metres_per_unit = 0.001            # of a model in millimetres\n\n";
  }
  return "\nunit = \"" + words.unit +
         "\"                           # of lengths in the file\nup = \"" + words.up +
         "\"                              # " +
         (words.up == "y" ? "(x, y, z) is body (x, -z, y)" : "its axes are the body's") +
         ", its origin the centre of rotation\n\n";
}

std::string materials_text(const SceneWords& words, const std::set<std::string>& materials) {
  if (!words.cad) {
    return listed("Materials whose optics may be given here instead of derived", materials) +
           "# [[material]]\n# name = \"...\"\n# absorptance = 0.9\n# diffuse = 0.1\n\n";
  }
  std::string text =
      "# The file contains no optical properties: measure them or use published values.\n";
  for (const std::string& name : materials) {
    text += "[[material]]\nname = " + quoted(name) + "\nabsorptance = 0.5\ndiffuse = 0.5\n\n";
  }
  return text;
}

std::string light_text(const GltfModel& model, const std::string& file, const SceneWords& words) {
  const Scene& scene = model.scene;
  std::set<std::string> nodes, materials;
  for (const Instance& instance : scene.instances) {
    nodes.insert(instance.path);
    if (!instance.material.empty()) materials.insert(instance.material);
  }
  const double radius_m = scene.radius_m(),
               height_m = std::max(0.0, box_of(scene).max().z()) + 2.0 * radius_m;
  const std::string lit = lit_node(scene);
  const Vec3 above_m = middle_m(scene, lit);
  // Removes the rounding residue of a coordinate that is zero in the model.
  const auto small = [&](double x_m) { return std::abs(x_m) < 1e-4 * radius_m ? 0.0 : x_m; };
  return "[scene]\nfile = " + quoted(file) + scene_text(words) + materials_text(words, materials) +
         "# ---- Light\n[[source]]\nkind = \"led\"                         # led | led_array | "
         "laser "
         "| sun | solar_simulator | ies | ray_file\npower_W = 10                          # "
         "radiant\n"
         "aperture_diameter_m = " +
         number(0.1 * radius_m) +
         "\nprofile = \"gaussian\"\nfwhm_deg = 10                         # of the radiant "
         "intensity\nwavelength_nm = 730\nposition_m = [" +
         number(small(above_m.x())) + ", " + number(small(above_m.y())) + ", " + number(height_m) +
         "]              # lab: z up; above the part that is measured\ndirection = [0, 0, -1]\n\n# "
         "---- What is measured\n" +
         listed("Parts", nodes) + "[[receiver]]\nkind = \"flux_map\"\nnode = " + quoted(lit) +
         "\nfacing = [0, 0, 1]                    # only faces turned up\nbins = [100, 100]\n\n"
         "[[receiver]]\nkind = \"wrench\"                       # force and torque of light on the "
         "whole\nname = \"platform\"\n\n[attitude]\ntilt_deg = 0\nheading_deg = 0\n\n[trace]\nrays "
         "= 1048576                        # standard errors fall with their root\n\n"
         "[torque_map]                          # torque-map: the torque of light at every "
         "attitude\n"
         "tilt_deg = [0, 10, 20, 30]\nheading_deg = [0, 45, 90, 135, 180, 225, 270, 315]   # 0: "
         "leans towards +x\n"
         "rays = 131072                         # at each\n";
}

void run(const Options& options, const Program&) {
  const Console console = terminal(options);
  std::error_code unreadable;
  if (fs::exists(options.experiment, unreadable)) {
    throw InputError({options.experiment.string()}, "", "an existing file",
                     "the name of a new file");
  }
  std::string text =
      "# Made by photorque new: a first experiment with assumed values. The name of a key ends "
      "with its unit; "
      "docs/experiment.md (scene, light) and docs/disturbances.md (platform) have them all.\n# "
      "photorque check " +
      options.experiment.filename().string() + " prints the commands that can run with it.\n\n";
  std::string size;
  if (options.scene) {
    const SceneWords words = scene_words(options);
    const GltfModel model =
        words.cad ? read_cad(*options.scene, *words.cad) : read_gltf(*options.scene);
    const fs::path file = fs::absolute(*options.scene)
                              .lexically_proximate(fs::absolute(options.experiment).parent_path());
    text += light_text(model, file.generic_string(), words);
    size = size_text(model.scene, *options.scene, words);
  } else {
    text += std::string(platform_text).substr(1);
  }
  text = with_overrides(text, options);
  // The folder must exist, because file names are relative to it.
  if (options.experiment.has_parent_path()) make_folders(options.experiment.parent_path());
  RunOptions checked;
  checked.experiment = options.experiment;
  checked.text = text;
  const CheckReport report = run_check(checked);
  if (!report.mistakes.empty()) throw InputError(report.mistakes.front());
  write_file_whole(options.experiment, text);
  console.line("Written to " + options.experiment.string());
  if (!size.empty()) console.line(size);
  for (const CheckReport::Command& command : report.commands) {
    console.line("  " + padded(command.name, 12) + command.what);
  }
  for (const std::string& note : report.notes) console.line("note: " + note);
}

}  // namespace

Verb kind() {
  return {
      "new",
      "A first experiment, commented: for a model (--scene; glTF, STL, OBJ), or a platform alone",
      command_with(add_options, run)};
}

}  // namespace photorque::verbs::new_experiment
