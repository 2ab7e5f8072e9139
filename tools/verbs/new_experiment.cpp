// photorque new: a first experiment with comments, for a user's model or for a platform alone.
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <utility>

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
  command.list.front().help = "Experiment file to write (TOML)";
  command.add("--scene", options.scene, "Model that is illuminated (glTF, GLB, STL or OBJ)");
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

double area_towards_m2(const Scene& scene, uint32_t instance, const Vec3& direction) {
  double area = 0.0;
  const std::vector<uint32_t> alone = {instance};
  for (const SurfaceFace& face : faces_of(scene, alone, direction)) {
    area += face.area_body_m2.dot(direction);
  }
  return area;
}

// Centre of the bounding box of all parts of that name.
Vec3 middle_m(const Scene& scene, const std::string& path) {
  const Eigen::AlignedBox3d box = box_of(scene, path);
  return box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.center());
}

// A part, and the direction from it to a lamp.
struct LitPart {
  std::string path;
  Vec3 to_lamp = Vec3::UnitZ();
  double score = 0.0;
};

// For each direction along an axis the part that most likely receives light from there, judged by
// its name, otherwise the part with the largest area seen from there. Likely ones come first.
std::vector<LitPart> lit_parts(const Scene& scene) {
  constexpr double above = 1.01;  // where a lamp usually hangs; decides between equal sides
  std::vector<LitPart> parts;
  for (const int axis : {2, 0, 1}) {
    for (const double sign : {1.0, -1.0}) {
      LitPart best{"", sign * Vec3::Unit(axis)};
      for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        const std::string& path = scene.instances[i].path;
        const auto contains = [&](const char* word) {
          return path.find(word) != std::string::npos;
        };
        const bool is_named = contains("solar") || contains("cells") || contains("panel");
        const double score = area_towards_m2(scene, i, best.to_lamp) * (is_named ? 1e6 : 1.0) *
                             (best.to_lamp.z() > 0.0 ? above : 1.0);
        if (score > best.score) best = {path, best.to_lamp, score};
      }
      parts.push_back(best);
    }
  }
  std::ranges::stable_sort(parts, std::greater(), &LitPart::score);
  return parts;
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

std::string triple(const Vec3& v) {
  return "[" + number(v.x()) + ", " + number(v.y()) + ", " + number(v.z()) + "]";
}

std::string light_text(const GltfModel& model, const std::string& file, const SceneWords& words,
                       const LitPart& lit) {
  const Scene& scene = model.scene;
  std::set<std::string> nodes, materials;
  for (const Instance& instance : scene.instances) {
    nodes.insert(instance.path);
    if (!instance.material.empty()) materials.insert(instance.material);
  }
  const double radius_m = scene.radius_m();
  const Eigen::AlignedBox3d box = box_of(scene);
  const double farthest_m =
      std::max(box.min().dot(lit.to_lamp), box.max().dot(lit.to_lamp));  // along an axis
  Vec3 lamp_m = middle_m(scene, lit.path);
  lamp_m += (std::max(0.0, farthest_m) + 2.0 * radius_m - lamp_m.dot(lit.to_lamp)) * lit.to_lamp;
  // Removes the rounding residue of a coordinate that is zero in the model.
  for (double& x_m : lamp_m) x_m = std::abs(x_m) < 1e-4 * radius_m ? 0.0 : x_m;
  return "[scene]\nfile = " + quoted(file) + scene_text(words) + materials_text(words, materials) +
         "# ---- Light\n[[source]]\nkind = \"led\"                         # led | led_array | "
         "laser "
         "| sun | solar_simulator | ies | ray_file\npower_W = 10                          # "
         "radiant\n"
         "aperture_diameter_m = " +
         number(0.1 * radius_m) +
         "\nprofile = \"gaussian\"\nfwhm_deg = 10                         # of the radiant "
         "intensity\nwavelength_nm = 730\nposition_m = " +
         triple(lamp_m) +
         "              # lab: z up; before the part that is measured\ndirection = " +
         triple(Vec3::Zero() - lit.to_lamp) + "\n\n# ---- Receivers\n" + listed("Parts", nodes) +
         "[[receiver]]\nkind = \"flux_map\"\nnode = " + quoted(lit.path) +
         "\nfacing = " + triple(Vec3::Zero() + lit.to_lamp) +
         "                    # only faces turned to the lamp\nbins = [100, 100]\n\n"
         "[[receiver]]\nkind = \"wrench\"                       # force and torque of light on the "
         "whole\nname = \"platform\"\n\n[attitude]\ntilt_deg = 0\nheading_deg = 0\n\n[trace]\nrays "
         "= 1048576                        # standard errors fall with their root\n\n"
         "[torque_map]                          # torque-map: the torque of light at every "
         "attitude\n"
         "tilt_deg = [0, 10, 20, 30]\nheading_deg = [0, 45, 90, 135, 180, 225, 270, 315]   # 0: "
         "leans towards +x\n"
         "rays = 131072                         # at each\n";
}

// A mistake in the text, without the name of its file, which is not written.
InputError without_file(const InputError& mistake, const fs::path& experiment) {
  std::string text = mistake.what();
  if (text.starts_with(experiment.string() + ":")) {
    text.erase(0, text.find(": ", experiment.string().size()));
  } else if (mistake.names_file()) {
    return mistake;
  } else {
    text.insert(0, ": ");
  }
  constexpr std::string_view first = ": found ", second = ", expected ";
  const size_t found = text.find(first), expected = text.find(second, found);
  if (expected == std::string::npos) return {{"photorque new"}, text.substr(2), "", ""};
  const size_t value = found + first.size();
  return {{"photorque new"},
          found > 0 ? text.substr(2, found - 2) : "",
          text.substr(value, expected - value),
          text.substr(expected + second.size())};
}

// The first of the texts without a mistake and the commands that can run with it. InputError with
// the mistake of the first text if all have one.
std::pair<std::string, CheckReport> first_right(const std::vector<std::string>& texts,
                                                const Options& options) {
  RunOptions checked;
  checked.experiment = options.experiment;
  std::optional<InputError> first;
  for (const std::string& text : texts) {
    try {
      checked.text = with_overrides(text, options);
      CheckReport report = run_check(checked);
      if (report.mistakes.empty()) return {*checked.text, std::move(report)};
      throw InputError(report.mistakes.front());
    } catch (const InputError& mistake) {
      if (!first) first = without_file(mistake, options.experiment);
    }
  }
  throw InputError(*first);
}

void run(const Options& options, const Program&) {
  const Console console = terminal(options);
  std::error_code unreadable;
  if (fs::exists(options.experiment, unreadable)) {
    throw InputError({options.experiment.string()}, "", "an existing file",
                     "the name of a new file");
  }
  const std::string head =
      "# Made by photorque new: a first experiment with assumed values. The name of a key ends "
      "with its unit; "
      "docs/experiment.md (scene, light) and docs/disturbances.md (platform) have them all.\n# "
      "photorque check " +
      options.experiment.filename().string() + " prints the commands that can run with it.\n\n";
  std::string size;
  std::vector<std::string> texts;  // in order of preference
  if (options.scene) {
    const SceneWords words = scene_words(options);
    const GltfModel model =
        words.cad ? read_cad(*options.scene, *words.cad) : read_gltf(*options.scene);
    const fs::path file = fs::absolute(*options.scene)
                              .lexically_proximate(fs::absolute(options.experiment).parent_path());
    for (const LitPart& lit : lit_parts(model.scene)) {
      texts.push_back(head + light_text(model, file.generic_string(), words, lit));
    }
    size = size_text(model.scene, *options.scene, words);
  } else {
    texts.push_back(head + std::string(platform_text).substr(1));
  }
  // The folder must exist, because file names are relative to it.
  if (options.experiment.has_parent_path()) make_folders(options.experiment.parent_path());
  const auto [text, report] = first_right(texts, options);
  write_file_whole(options.experiment, text);
  if (options.json) print_json(report);
  console.line("Written to " + options.experiment.string());
  if (!size.empty()) console.line(size);
  for (const CheckReport::Command& command : report.commands) {
    console.line("  " + padded(command.name, 12) + command.what);
  }
  for (const std::string& note : report.notes) console.line("note: " + note);
}

}  // namespace

Verb kind() {
  return {"new",
          "A first experiment with comments, for a model (--scene; glTF, STL, OBJ) or for a "
          "platform alone",
          command_with(add_options, run)};
}

}  // namespace photorque::verbs::new_experiment
