#include "receivers/kind.h"

#include <cmath>
#include <numeric>
#include <set>
#include <sstream>

#include "core/text/format.h"

namespace photorque {
namespace {

namespace target_key {
constexpr TextKey node("node", "a node of the scene, with the nodes below it");
constexpr TextKey name("name", "name of the results", {.usually = "the node"});
}  // namespace target_key

namespace grid_key {
constexpr NumbersKey bins("bins", {1.0, max_grid_bins}, "number of bins [along u, along v]",
                          {.optional = true, .size = 2});
constexpr ChoiceKey over("over",
                         {{"plane", "a plane that fits the surface"},
                          {"uv", "the texture coordinates"}},
                         0, "surface of the bins");
constexpr ChoiceKey side("side", {"front", "back", "both"}, "side of the surface that counts");
constexpr Vec3Key facing("facing",
                         "only faces that point in this body direction; required for closed bodies",
                         {.usually = "all faces"});
}  // namespace grid_key

// All names that `node` accepts: the components of all paths.
std::set<std::string> node_names(const Scene& scene) {
  std::set<std::string> names;
  for (const Instance& instance : scene.instances) {
    std::istringstream path(instance.path);
    for (std::string part; std::getline(path, part, '/');) names.insert(part);
    names.insert(instance.node);
  }
  names.erase("");
  return names;
}

std::string known_nodes(const Scene& scene, const std::string& wanted) {
  return "a node of the scene that holds a mesh: " + listed_names(node_names(scene), wanted);
}

// File names contain it, with a few words before and after.
constexpr size_t longest_name = 150;

std::string read_name(const Settings& settings, const std::string& otherwise) {
  const std::string name = settings.get_or(target_key::name, otherwise);
  if (name.empty()) throw settings.error(target_key::name, "an empty text", "a name");
  if (settings.has(target_key::name) && name.size() > longest_name) {
    throw settings.error(target_key::name, std::to_string(name.size()) + " letters", "at most 150");
  }
  return receiver_name(name);
}

int read_bins(const Settings& settings, double bins) {
  if (!(bins >= 1 && bins <= max_grid_bins && bins == std::floor(bins))) {
    throw settings.error(grid_key::bins, printed("%g", bins),
                         "two whole numbers from 1 to " + std::to_string(max_grid_bins));
  }
  return static_cast<int>(bins);
}

}  // namespace

std::string receiver_name(std::string name) {
  if (name.size() > longest_name) name.resize(longest_name);
  for (char& c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '_' || c == '-' || c == '.';
    if (!plain) c = '_';
  }
  return name;
}

ReceiverTarget read_target(const Settings& settings, const Scene& scene) {
  const std::string node = settings.get(target_key::node);
  std::vector<uint32_t> instances;
  if (!node.empty()) instances = scene.instances_of(node);
  if (instances.empty()) {
    throw settings.error(target_key::node, "\"" + node + "\"", known_nodes(scene, node));
  }
  return {read_name(settings, node.substr(node.find_last_of('/') + 1)), std::move(instances)};
}

ReceiverTarget read_target_or_all(const Settings& settings, const Scene& scene,
                                  const std::string& otherwise_name) {
  if (settings.has(target_key::node)) return read_target(settings, scene);
  std::vector<uint32_t> all(scene.instances.size());
  std::iota(all.begin(), all.end(), 0u);
  return {read_name(settings, otherwise_name), std::move(all)};
}

SurfaceGrid read_surface_grid(const Settings& settings, const Scene& scene,
                              const ReceiverTarget& target, Side default_side) {
  SurfaceGridOptions options;
  options.where = settings.where();
  options.key = settings.name();
  if (settings.has(grid_key::bins)) {
    const std::vector<double> bins = settings.numbers(grid_key::bins);
    if (bins.size() != 2) {
      throw settings.error(grid_key::bins, "an array of " + std::to_string(bins.size()),
                           "two whole numbers");
    }
    options.width = read_bins(settings, bins[0]);
    options.height = read_bins(settings, bins[1]);
  }
  options.over =
      settings.get(grid_key::over) == 0 ? SurfaceGrid::Over::plane : SurfaceGrid::Over::texture;
  options.side = static_cast<Side>(
      settings.get(grid_key::side.with_default(static_cast<size_t>(default_side))));
  if (settings.has(grid_key::facing)) {
    options.facing_body = settings.get(grid_key::facing);
    if (!(options.facing_body->norm() > 0.0)) {
      throw settings.error(grid_key::facing, "[0, 0, 0]", "a direction in body axes");
    }
  }
  return make_surface_grid(scene, target.instances, options);
}

std::vector<Key> target_keys() {
  return {target_key::node, target_key::name};
}

std::vector<Key> target_or_all_keys(const std::string& otherwise_name) {
  return {target_key::node.usually("everything"),
          target_key::name.usually("the node, or `" + otherwise_name + "`")};
}

std::vector<Key> surface_grid_keys(Side default_side) {
  using namespace grid_key;
  Key counts = bins;
  const SurfaceGridOptions usual;
  counts.otherwise = {SettingsNode::Array{{int64_t{usual.width}}, {int64_t{usual.height}}}};
  return {counts, over, side.with_default(static_cast<size_t>(default_side)), facing};
}

}  // namespace photorque
