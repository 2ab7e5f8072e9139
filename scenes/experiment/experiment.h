// One experiment file: the nominal model of the laboratory, ready to trace.
//
// The file is read in two steps. ExperimentFile contains the text, checked as far as possible
// without the scene. Experiment contains the scene, beams and receivers to which the text refers.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/settings/settings.h"
#include "core/transform.h"
#include "raytrace/receiver.h"
#include "raytrace/scene.h"
#include "raytrace/tracing/tracer.h"
#include "receivers/gather/bodies/molecular_flow.h"
#include "receivers/kind.h"
#include "scenes/cad/model.h"
#include "scenes/experiment/joints.h"
#include "scenes/gltf/reader.h"

namespace photorque {

// [attitude]: attitude of the platform; see lab_from_body_at().
struct Attitude {
  double tilt_rad = 0.0;     // in [0, π]
  double heading_rad = 0.0;  // azimuth of the tilt direction, from lab x (east) towards y
};

// [torque_map]: attitudes of a wrench table, every tilt with every heading.
struct AttitudeGrid {
  std::vector<double> tilt_rad;     // ascending, at least one
  std::vector<double> heading_rad;  // ascending, at least one
};

// [torque_map] with elevations and azimuths: directions to the Sun in body axes, every elevation
// with every azimuth, for the wrench table of a body in sunlight.
struct DirectionGrid {
  std::vector<double> elevation_rad;  // ascending in [−π/2, π/2], at least one
  std::vector<double> azimuth_rad;    // ascending in [−π, π], from x towards y, at least one
};

// [trace]: effort for the light on surfaces.
struct TraceEffort {
  // Whether direct light is gathered over the surface instead of traced, if that is possible.
  // automatic: unless gathering would take much longer than the rays.
  enum class Direct { automatic, gather, rays };
  Direct direct = Direct::automatic;
  // Adds rays until every bin above a tenth of its map's maximum has this relative standard error,
  std::optional<double> target_error;
  std::optional<double> max_time_s;  // or until the next round would end later than this
  // Number of rays in a separate trace whose arriving rays are written to a file per flux map.
  // Empty: no file.
  std::optional<uint64_t> arriving_rays;
};

// [camera]: viewpoint of a picture. Lab frame; z is up in the picture.
struct Camera {
  Vec3 position_m = Vec3::Zero();
  Vec3 target_m = Vec3::Zero();
  double field_of_view_rad = 0.6;  // across the width of the picture, in (0, π)
  int width = 1280;                // pixels
  int height = 960;
  bool lamps = true;    // lamps and some of their rays are drawn
  bool placed = false;  // the experiment states its position
};

// Camera that shows a whole scene of `radius_m` about the lab origin, from the south-east and
// above. The sphere of this radius just fits into the picture.
Camera camera_framing(double radius_m);

// [torque_map.molecular_flow]: a gas, and the surfaces of the scene's instances in it.
struct MolecularFlow {
  double speed_ratio = 0.0;  // v/√(2RT)
  std::vector<GasWall> walls;
};

// The content of an experiment file.
struct ExperimentFile {
  std::filesystem::path path;
  // The whole file with overrides.
  Settings settings{SettingsNode{}};
  // For Provenance: this file and the overrides.
  std::vector<std::pair<std::string, std::string>> inputs;

  // Model of an optical run; empty if the file has no [scene].
  std::optional<std::filesystem::path> scene_file;
  double metres_per_unit = 1.0;       // [scene] metres_per_unit: of lengths in the model's file
  std::optional<CadConventions> cad;  // [scene] unit and up, if the file is not glTF
  // [scene] centre_of_rotation_m: its position in the model, body axes
  Vec3 centre_of_rotation_m = Vec3::Zero();
  bool textures = false;  // [scene] textures: take base colours from the model's pictures
  // [scene] allow_outside: the model may refer to files outside its folder
  bool may_leave_folder = false;
  Bands bands;
  std::vector<Settings> materials;  // [[material]], overrides by name
  std::vector<Settings> sources;
  std::vector<Beam> further_beams = {};  // lamps that the text does not contain, lab frame
  std::vector<Settings> receivers;
  std::vector<Settings> joint_tables;  // [[joint]]
  std::vector<Joint> joints;

  Attitude attitude;
  TraceOptions trace;
  TraceEffort effort;
  AttitudeGrid torque_map;
  std::optional<DirectionGrid> light_directions;  // instead of torque_map
  std::optional<uint64_t> torque_map_rays;        // per attitude or direction; else trace.rays
  std::optional<Settings> molecular_flow;         // [torque_map.molecular_flow]
  std::optional<Settings> camera;

  // Tables that other parts of the program read ([array], [platform], [environment],
  // [[disturbance]], [sensors], [recording]). Each item records the keys that are read; its reader
  // must call finish() on it. Empty if the file has none.
  std::vector<Settings> others(const std::string& key) const;
};

// Reads the text and the overrides ("KEY=VALUE", see apply_override()). Throws InputError for all
// errors that can be found without the scene, except in the tables of sources, receivers and
// materials, which are read later.
ExperimentFile read_experiment_file(const std::filesystem::path& path,
                                    std::span<const std::string> overrides = {});

// Reads a text. Messages call it `path`; files that it names are relative to the folder of that
// path.
ExperimentFile read_experiment_text(const std::filesystem::path& path, const std::string& text,
                                    std::span<const std::string> overrides = {});

// A receiver with its kind and its name in the experiment.
struct NamedReceiver : MadeReceiver {
  std::string name;  // the key `name`, else the node, else the kind
  std::string kind;
};

// All inputs of an optical run.
struct Experiment {
  ExperimentFile file;
  Scene scene;
  std::vector<Beam> beams;  // lab frame
  std::vector<NamedReceiver> receivers;
  RigidTransform lab_from_body;  // from [attitude]
  Camera camera;
  std::optional<MolecularFlow> flow = {};  // instead of beams
  std::vector<std::string> notices;        // assumptions of the scene's reader, one line each
  // Reasons to doubt the results, one line each: see geometry_warnings().
  std::vector<std::string> warnings = {};
  std::vector<std::pair<std::string, std::string>> inputs;  // experiment, overrides, scene files

  // The receivers for trace(), in their order.
  std::vector<const Receiver*> receiver_pointers() const;
};

// Loads the parts to which the file refers. Throws InputError for: no [scene], a scene without
// triangles, neither source nor gas flow, a source whose spectrum exceeds the bands, a receiver on
// a missing node, any key that was not read, and textures without a `picture` reader.
Experiment resolve_experiment(ExperimentFile file, const PictureReader& picture = {});

// Marks closed opaque parts that contain a lamp and all other parts, such as a vacuum chamber, as
// not enclosing: their inner sides are meant to be lit.
void open_chambers(Scene& scene, std::span<const Beam> beams, const RigidTransform& lab_from_body);

// Warnings, one line each: lamps whose centre is inside a closed opaque part, at this attitude;
// parts that are too small, compared with the scene, for the single precision of ray casting.
std::vector<std::string> geometry_warnings(const Scene& scene, std::span<const Beam> beams,
                                           const RigidTransform& lab_from_body);

}  // namespace photorque
