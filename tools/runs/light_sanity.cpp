#include "tools/runs/light_sanity.h"

#include <algorithm>
#include <cmath>

namespace photorque {
namespace {

// The lamps of one [[source]]: their names are NAME or NAME[0], NAME[1], …
std::vector<Beam> beams_of(const Experiment& experiment, const Settings& source) {
  const std::string name = source.text_or("name", source.text_or("kind", ""));
  std::vector<Beam> beams;
  for (const Beam& beam : experiment.beams) {
    if (beam.name == name || beam.name.starts_with(name + "[")) beams.push_back(beam);
  }
  return beams;
}

struct FewRays {
  InsideLightReceiver inside;
  std::vector<const Receiver*> receivers;  // those of the experiment, then `inside`
  TraceOptions options;

  explicit FewRays(const Experiment& experiment)
      : inside(experiment.scene), receivers(experiment.receiver_pointers()) {
    receivers.push_back(&inside);
    options = experiment.file.trace;
    options.replicates = 8;
    options.rays = 16384;
  }
};

// Fraction of the power that a source sends to the scene: more than the loss through cracks, less
// than one lamp of a thousand.
constexpr double noticeable = 1e-3;

std::string inside_of(const Experiment& experiment, const InsideLightReceiver& inside,
                      const BinSums& sums, double sent_W) {
  for (const auto& part : inside.lit_inside(sums)) {
    if (part.inside_W.value > noticeable * sent_W) {
      return experiment.scene.instances[part.instance].path;
    }
  }
  return "";
}

// Whether the faces of a part point inwards: then the enclosed volume (sum of the tetrahedra from
// the origin to each face) is negative.
bool is_turned_inwards(const Scene& scene, const std::string& path) {
  double six_volumes_m3 = 0.0;
  for (const Instance& instance : scene.instances) {
    if (instance.path != path) continue;
    const Mesh& mesh = scene.meshes[instance.mesh];
    // A mirrored instance is traced with reversed winding.
    const double sign = instance.body_from_mesh.linear().determinant() < 0.0 ? -1.0 : 1.0;
    for (const auto& face : mesh.triangles) {
      const auto corner = [&](size_t k) {
        return Vec3(instance.body_from_mesh * mesh.vertices_m[face[k]]);
      };
      six_volumes_m3 += sign * corner(0).dot(corner(1).cross(corner(2)));
    }
  }
  return six_volumes_m3 < 0.0;
}

// Whether a source has a position; the light of a sun starts outside all parts.
bool has_place(const std::vector<Beam>& beams) {
  return std::ranges::any_of(beams, [](const Beam& beam) {
    return !beam.aperture || !std::isinf(beam.aperture->radius_m);
  });
}

double lit_W(const NamedReceiver& receiver, const BinSums& sums) {
  return receiver.flux_map->flux_map(sums).incident.power_W.value;
}

}  // namespace

std::vector<InputError> unlit_receiver_errors(const OpticalRun& run) {
  constexpr size_t max_lamps = 256;
  constexpr double rounding = 1e-9;
  const Experiment& experiment = run.experiment();
  if (experiment.beams.size() > max_lamps) return {};
  const FewRays few(experiment);
  std::vector<InputError> mistakes;
  std::vector<double> on_receiver_W(experiment.receivers.size(), 0.0);
  for (const Settings& source : experiment.file.sources) {
    const std::vector<Beam> beams = beams_of(experiment, source);
    if (beams.empty()) continue;  // another source has the same name
    const TraceResult result =
        trace(run.scene(), experiment.lab_from_body, beams, few.receivers, few.options);
    const std::string part = inside_of(experiment, few.inside, result.sums.back(), result.sent_W);
    if (!part.empty() && is_turned_inwards(experiment.scene, part)) {
      mistakes.push_back({source.where(), "scene.file",
                          "\"" + part + "\", whose faces point inwards: light falls on their backs",
                          "faces that look outwards (turn them where the model was made)"});
    } else if (!part.empty() && has_place(beams)) {
      mistakes.push_back(
          source.error("position_m", "a place inside of \"" + part + "\"", "one outside of it"));
    } else if (has_place(beams) &&                // a sun may light the edges of sheets alone
               result.segments == result.rays &&  // a white scene lets all of its light escape, too
               result.power_balance.escaped_W.value >=
                   (1.0 - rounding) * result.power_balance.emitted_W) {
      mistakes.push_back(source.error("direction", "light that misses the scene", "light on it"));
    }
    for (size_t i = 0; i < experiment.receivers.size(); ++i) {
      if (!experiment.receivers[i].flux_map) continue;
      on_receiver_W[i] += lit_W(experiment.receivers[i], result.sums[i]);
    }
  }
  if (!mistakes.empty()) return mistakes;  // These mistakes explain dark maps.
  for (size_t i = 0; i < experiment.file.receivers.size(); ++i) {
    const NamedReceiver& receiver = experiment.receivers[i];
    if (!receiver.flux_map || on_receiver_W[i] > 0.0) continue;
    mistakes.push_back(experiment.file.receivers[i].error(
        "node", "\"" + receiver.name + "\", which no light reaches",
        "a lit part; check `node`, `side` and `facing`"));
  }
  return mistakes;
}

}  // namespace photorque
