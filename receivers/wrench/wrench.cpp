#include "receivers/wrench/wrench.h"

#include <set>

#include "receivers/kind.h"
#include "receivers/wrench/table_product.h"

namespace photorque {
namespace {

constexpr size_t wrench_components = std::tuple_size_v<WrenchComponents>;

// Shortest names that are unique: nodes, else paths, else paths with material, else paths with
// number.
std::vector<std::string> unique_names(const Scene& scene, const std::vector<uint32_t>& instances) {
  const std::function<std::string(uint32_t)> spellings[] = {
      [&](uint32_t i) { return scene.instances[i].node; },
      [&](uint32_t i) { return scene.instances[i].path; },
      [&](uint32_t i) { return scene.instances[i].path + ":" + scene.instances[i].material; },
      [&](uint32_t i) { return scene.instances[i].path + "#" + std::to_string(i); }};
  std::vector<std::string> names;
  for (const auto& spelling : spellings) {
    names.clear();
    for (const uint32_t instance : instances) names.push_back(spelling(instance));
    if (std::set<std::string>(names.begin(), names.end()).size() == names.size()) break;
  }
  return names;
}

// Adds the hits [begin, end), which are all on one part.
void add_run(const Hits& hits, size_t begin, size_t end, const Vec3& about_m,
             std::span<double> sums) {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  for (size_t i = begin; i < end; ++i) {
    const Vec3 f = hits.force_at_N(i);
    force += f;
    torque += (hits.position_at_m(i) - about_m).cross(f);
  }
  Eigen::Map<Vec3>(sums.data()) += force;
  Eigen::Map<Vec3>(sums.data() + 3) += torque;
}

}  // namespace

WrenchReceiver::WrenchReceiver(std::string name, const Scene& scene,
                               std::vector<uint32_t> instances, const Vec3& about_body_m)
    : name_(std::move(name)),
      about_body_m_(about_body_m),
      part_names_(unique_names(scene, instances)),
      part_of_instance_(scene.instances.size(), static_cast<uint32_t>(instances.size())) {
  for (uint32_t part = 0; part < instances.size(); ++part) {
    part_of_instance_[instances[part]] = part;
  }
}

size_t WrenchReceiver::bins() const {
  return 2 * part_names_.size() * wrench_components;
}

// Neighbouring hits usually share the instance; a run of them is summed in registers.
void WrenchReceiver::score(const Hits& hits, std::span<double> sums) const {
  const auto count = static_cast<size_t>(hits.count);
  for (size_t begin = 0, end = 0; begin < count; begin = end) {
    const uint32_t instance = hits.instance[begin];
    while (end < count && hits.instance[end] == instance) ++end;
    const size_t part = part_of_instance_[instance];
    if (part == part_names_.size()) continue;
    const size_t entry = part * wrench_components + (hits.depth > 0 ? direct_entries() : 0);
    add_run(hits, begin, end, about_body_m_, sums.subspan(entry, wrench_components));
  }
}

// Sum over the groups of six bins for which counts(group) is true. Error bounds, which the scatter
// of the replicates does not show, are added linearly.
WrenchEstimate WrenchReceiver::estimate(const BinSums& sums,
                                        const std::function<bool(size_t)>& counts) const {
  std::vector<WrenchComponents> replicates(static_cast<size_t>(sums.replicates));
  WrenchComponents bound{};
  for (size_t group = 0; group < bins() / wrench_components; ++group) {
    if (!counts(group)) continue;
    for (size_t k = 0; k < wrench_components; ++k) {
      const size_t bin = group * wrench_components + k;
      for (size_t r = 0; r < replicates.size(); ++r) {
        replicates[r][k] += sums.of(static_cast<int>(r))[bin];
      }
      bound[k] += sums.bound_of(bin);
    }
  }
  WrenchEstimate wrench = wrench_from_replicates(replicates, about_body_m_);
  for (size_t k = 0; k < wrench_components; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    wrench.covariance(i, i) += bound[k] * bound[k];
  }
  return wrench;
}

std::vector<WrenchEstimate> WrenchReceiver::by_part(const BinSums& sums) const {
  const size_t parts = part_names_.size();
  std::vector<WrenchEstimate> wrenches;
  for (size_t part = 0; part < parts; ++part) {
    wrenches.push_back(estimate(sums, [&](size_t group) { return group % parts == part; }));
  }
  return wrenches;
}

WrenchEstimate WrenchReceiver::total(const BinSums& sums) const {
  return estimate(sums, [](size_t) { return true; });
}

WrenchEstimate WrenchReceiver::direct(const BinSums& sums) const {
  return estimate(sums, [&](size_t group) { return group < part_names_.size(); });
}

Product WrenchReceiver::product(const BinSums& sums) const {
  std::vector<WrenchEstimate> wrenches = by_part(sums);
  std::vector<std::string> names = part_names_;
  wrenches.push_back(total(sums));
  names.emplace_back("total");
  Product product;
  product.quantities = wrench_quantities(wrenches.back(), name_);
  product.tables.push_back(wrench_rows(wrenches, names, name_));
  return product;
}

std::vector<Quantity> wrench_quantities(const WrenchEstimate& wrench, const std::string& name) {
  const std::string where = "_" + name + (wrench.mean.frame == Frame::body ? "_body" : "_lab");
  std::vector<Quantity> quantities;
  const auto add = [&](const char* kind, const char* unit, const Vec3& value, const Vec3& error) {
    for (int axis = 0; axis < 3; ++axis) {
      quantities.push_back(
          {std::string(kind) + "xyz"[axis] + where + unit, {value[axis], error[axis]}});
    }
  };
  add("force_", "_N", wrench.mean.force_N, wrench.force_error_N());
  add("torque_", "_N_m", wrench.mean.torque_N_m, wrench.torque_error_N_m());
  return quantities;
}

Table wrench_rows(const std::vector<WrenchEstimate>& wrenches,
                  const std::vector<std::string>& names, const std::string& name) {
  Table table = Table::of("wrench_" + name, "Force and torque of light on " + name);
  table.add("part", names);
  std::vector<Vec3> force, torque, force_error, torque_error;
  for (const WrenchEstimate& wrench : wrenches) {
    force.push_back(wrench.mean.force_N);
    torque.push_back(wrench.mean.torque_N_m);
    force_error.push_back(wrench.force_error_N());
    torque_error.push_back(wrench.torque_error_N_m());
  }
  add_components(table, "force", "N", force);
  add_components(table, "torque", "N_m", torque);
  add_components(table, "force_error", "N", force_error);
  add_components(table, "torque_error", "N_m", torque_error);
  return table;
}

namespace kinds::wrench {

ReceiverKind kind() {
  return {"wrench", "Force and torque of light on the whole body or a node, in total and per part",
          [](const Settings& settings, const Scene& scene) -> MadeReceiver {
            ReceiverTarget target = read_target_or_all(settings, scene, "platform");
            const auto wrench = std::make_shared<const WrenchReceiver>(
                target.name, scene, std::move(target.instances), settings.get(torque_point));
            return {.receiver = wrench, .wrench = wrench};
          },
          joined({target_or_all_keys("platform"), {torque_point}})};
}

}  // namespace kinds::wrench

}  // namespace photorque
