// Second step of reading an experiment: the scene, beams and receivers to which the text refers.
#include "scenes/experiment/experiment.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/constants.h"
#include "core/files.h"
#include "core/settings/files.h"
#include "core/text/format.h"
#include "receivers/kind.h"
#include "scenes/experiment/keys.h"
#include "scenes/gltf/coincident.h"
#include "scenes/gltf/lights.h"
#include "scenes/gltf/reader.h"
#include "sources/lamps/kind.h"

namespace photorque {
namespace {

template <typename Kind>
std::vector<std::string> names_of(const std::vector<Kind>& kinds) {
  std::vector<std::string> names;
  for (const Kind& kind : kinds) names.push_back(kind.name);
  return names;
}

void require_spectrum_inside(const Settings& source, const Beam& beam, const Bands& bands) {
  // Small enough for a Gaussian that is cut at five standard deviations.
  constexpr double negligible = 1e-6;
  const BandValues fractions = band_fractions(beam.spectrum, bands);
  double inside = 0.0;
  for (const double fraction : fractions) inside += fraction;
  if (inside >= 1.0 - negligible) return;
  throw source.error(
      "", printed("a spectrum with %.3g %% of its power outside the bands", 100.0 * (1.0 - inside)),
      "[scene] bands_nm that hold all of it");
}

// Rejects sources that are too far away or too wide for tracing in single precision.
void require_traceable(const Settings& source, const Beam& beam) {
  const double away_m = beam.lab_from_emitter.translation_m.stableNorm();
  if (!(away_m <= largest_distance_m)) {
    throw source.error("", printed("a lamp %g m away", away_m), "at most 1e12 m");
  }
  SampleBlock samples;
  sobol_points({}, 0, samples.columns());
  RayBlock rays;
  beam.emitter->emit(samples, rays);
  for (const auto& origins_m : rays.origin_m) {
    for (const float origin_m : origins_m) {
      if (std::abs(origin_m) <= largest_extent_m) continue;
      throw source.error(
          "",
          printed("light that starts %g m from the lamp's middle", static_cast<double>(origin_m)),
          "an opening of at most 1e9 m");
    }
  }
}

// Makes the beams. Notices and input files of the sources are added to those of the model.
std::vector<Beam> make_beams(const ExperimentFile& file, GltfModel& model) {
  const Scene& scene = model.scene;
  if (file.molecular_flow) return {};
  if (file.sources.empty() && file.further_beams.empty())
    throw file.settings.error("source", "nothing", "at least one [[source]]");
  const std::vector<SourceKind> kinds = all_source_kinds();
  std::vector<Beam> beams;
  std::optional<std::vector<GltfLight>> lights;  // of the scene, once a source asks for one
  for (const Settings& written : file.sources) {
    if (written.has("light") && file.cad) {
      throw written.error("light", "a scene of STL or OBJ", "a glTF file, which may place lamps");
    }
    if (written.has("light") && !lights) {
      lights = read_gltf_lights(*file.scene_file, file.metres_per_unit, file.may_leave_folder);
      for (GltfLight& light : *lights) light.position_m -= file.centre_of_rotation_m;
    }
    const bool at_light = written.has("light");
    const Settings source = at_light ? source_at_light(written, *lights) : written;
    const SourceContext context{
        .scene_radius_m = scene.radius_m(),
        .notice =
            [&](const std::string& line) { model.notices.push_back(source.name() + ": " + line); },
        .folder = file.path.parent_path(),
        .input = [&](const std::string& name,
                     const std::string& hash) { model.inputs.emplace_back(name, hash); },
        .within =
            [&](const std::string& name) {
              return at_light ? profile_of_lights(*lights, name) : std::nullopt;
            }};
    const SourceKind& kind = kinds[source.choice("kind", names_of(kinds))];
    for (Beam& beam : kind.make(source, context)) {
      require_spectrum_inside(source, beam, scene.bands);
      require_traceable(source, beam);
      beams.push_back(std::move(beam));
    }
    if (at_light) source.finish();
  }
  for (const Beam& beam : file.further_beams) {
    const Settings lamp(SettingsNode{}, "lamp \"" + beam.name + "\"");
    require_spectrum_inside(lamp, beam, scene.bands);
    require_traceable(lamp, beam);
    beams.push_back(beam);
  }
  return beams;
}

const ReceiverKind& kind_of(const Settings& receiver, const std::vector<ReceiverKind>& kinds) {
  const std::vector<std::string> names = names_of(kinds);
  if (receiver.has("kind") || !receiver.has("node")) return kinds[receiver.choice("kind", names)];
  return *std::find_if(kinds.begin(), kinds.end(),
                       [](const ReceiverKind& kind) { return kind.name == "flux_map"; });
}

NamedReceiver make_receiver(const Settings& settings, const Scene& scene,
                            const std::vector<ReceiverKind>& kinds) {
  const ReceiverKind& kind = kind_of(settings, kinds);
  std::string name = settings.has("node") ? read_target(settings, scene).name
                                          : settings.text_or("name", kind.name);
  return {kind.make(settings, scene), std::move(name), kind.name};
}

std::vector<NamedReceiver> make_receivers(const ExperimentFile& file, const Scene& scene) {
  const std::vector<ReceiverKind> kinds = all_receiver_kinds();
  std::vector<NamedReceiver> receivers;
  // Receivers of equal kind and name would overwrite each other's files.
  std::set<std::pair<std::string, std::string>> taken;
  for (const Settings& settings : file.receivers) {
    receivers.push_back(make_receiver(settings, scene, kinds));
    const NamedReceiver& added = receivers.back();
    if (!taken.emplace(added.kind, added.name).second) {
      throw settings.error("name", "a second " + added.kind + " called \"" + added.name + "\"",
                           "a unique name");
    }
  }
  return receivers;
}

Camera read_camera(const ExperimentFile& file, double scene_radius_m) {
  Camera camera = camera_framing(scene_radius_m);
  if (!file.camera) return camera;
  const Settings& settings = *file.camera;
  camera.position_m = settings.get_or(camera_key::position, camera.position_m);
  camera.target_m = settings.get_or(camera_key::target, camera.target_m);
  camera.field_of_view_rad = settings.get_or(camera_key::field_of_view, camera.field_of_view_rad);
  camera.width = static_cast<int>(settings.get_or(camera_key::width, camera.width));
  camera.height = static_cast<int>(settings.get_or(camera_key::height, camera.height));
  camera.lamps = settings.get(camera_key::lamps);
  camera.placed = settings.has(camera_key::position) || settings.has(camera_key::target);
  if ((camera.position_m - camera.target_m).norm() < 1e-9) {
    throw settings.error(camera_key::position, "the target itself", "a point away from target_m");
  }
  return camera;
}

std::optional<MolecularFlow> read_flow(const ExperimentFile& file, const Scene& scene) {
  if (!file.molecular_flow) return std::nullopt;
  using namespace torque_map_key;
  const Settings& gas = *file.molecular_flow;
  const double gas_K = gas.get(gas_temperature);
  const double specific_J_kg_K = boltzmann_J_K * avogadro_1_mol / gas.get(molar_mass);
  MolecularFlow flow{gas.get(flow_speed) / std::sqrt(2.0 * specific_J_kg_K * gas_K), {}};
  const GasWall whole{gas.get(accommodation), gas.get(wall_temperature) / gas_K};
  flow.walls.assign(scene.instances.size(), whole);
  for (const Settings& part : gas.get(flow_part)) {
    const GasWall wall{part.get_or(accommodation, whole.accommodation),
                       part.get_or(wall_temperature, whole.temperature_ratio * gas_K) / gas_K};
    for (const uint32_t instance : read_target(part, scene).instances) flow.walls[instance] = wall;
  }
  return flow;
}

// The message contains the file name as the user wrote it, at its position in the experiment.
void require_scene_file(const ExperimentFile& file) {
  if (!file.scene_file) {
    throw file.settings.error(scene_key::scene, "nothing", "a table [scene] with a file");
  }
  std::error_code unreadable;
  if (std::filesystem::is_regular_file(*file.scene_file, unreadable)) return;
  const Settings scene = file.settings.get(scene_key::scene);
  require_plain_file(existing_file(scene, scene_key::file, file.path.parent_path()));
}

GltfModel read_model(const ExperimentFile& file, const PictureReader& picture) {
  constexpr uint64_t largest_bytes = 1ull << 28;  // of a file of a material
  const GltfOptions options{
      .bands = file.bands,
      .materials = file.materials,
      .material_file = files_beside(file.path.parent_path(), largest_bytes, true),
      .picture = file.textures ? picture : nullptr,
      .metres_per_unit = file.metres_per_unit,
      .origin_m = file.centre_of_rotation_m,
      .may_leave_folder = file.may_leave_folder};
  return file.cad ? read_cad(*file.scene_file, *file.cad, options)
                  : read_gltf(*file.scene_file, options);
}

void require_triangles(const Scene& scene, const std::filesystem::path& path) {
  const bool any = std::any_of(
      scene.instances.begin(), scene.instances.end(),
      [&](const Instance& instance) { return !scene.meshes[instance.mesh].triangles.empty(); });
  if (!any) throw InputError({path.string()}, "", "no triangles", "a scene with at least one mesh");
}

}  // namespace

Camera camera_framing(double radius_m) {
  Camera camera;
  const double half_width = 0.5 * camera.field_of_view_rad;
  const double half_height = std::atan(std::tan(half_width) * camera.height / camera.width);
  const double distance_m = std::max(radius_m, 1e-6) / std::sin(std::min(half_width, half_height));
  camera.position_m = distance_m * Vec3(0.5, -0.7, 0.5).normalized();
  return camera;
}

std::vector<const Receiver*> Experiment::receiver_pointers() const {
  std::vector<const Receiver*> pointers;
  for (const NamedReceiver& named : receivers) pointers.push_back(named.receiver.get());
  return pointers;
}

Experiment resolve_experiment(ExperimentFile file, const PictureReader& picture) {
  require_scene_file(file);
  if (file.textures && !picture) {
    throw file.settings.get(scene_key::scene)
        .error(scene_key::textures, "true", "false: this program cannot read pictures");
  }
  GltfModel model = read_model(file, picture);
  require_triangles(model.scene, *file.scene_file);
  turn_joints(model.scene, file.joints, file.joint_tables);
  for (std::string& line : separate_coincident_faces(model.scene)) {
    model.notices.push_back(std::move(line));
  }

  std::vector<Beam> beams = make_beams(file, model);
  std::vector<NamedReceiver> receivers = make_receivers(file, model.scene);
  const Camera camera = read_camera(file, model.scene.radius_m());
  std::optional<MolecularFlow> flow = read_flow(file, model.scene);
  file.settings.finish();

  Experiment experiment;
  experiment.file = std::move(file);
  experiment.scene = std::move(model.scene);
  experiment.beams = std::move(beams);
  experiment.receivers = std::move(receivers);
  experiment.lab_from_body =
      lab_from_body_at(experiment.file.attitude.tilt_rad, experiment.file.attitude.heading_rad);
  experiment.camera = camera;
  experiment.flow = std::move(flow);
  open_chambers(experiment.scene, experiment.beams, experiment.lab_from_body);
  experiment.warnings =
      geometry_warnings(experiment.scene, experiment.beams, experiment.lab_from_body);
  experiment.notices = std::move(model.notices);
  experiment.inputs = experiment.file.inputs;
  experiment.inputs.insert(experiment.inputs.end(), model.inputs.begin(), model.inputs.end());
  return experiment;
}

}  // namespace photorque
