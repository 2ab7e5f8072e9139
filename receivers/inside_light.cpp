#include "receivers/inside_light.h"

#include <algorithm>

#include "core/text/format.h"

namespace photorque {

InsideLightReceiver::InsideLightReceiver(const Scene& scene)
    : part_of_instance_(scene.instances.size()) {
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (!scene.meshes[instance.mesh].encloses) continue;
    if (any_positive(scene.surfaces[instance.front_surface].transmitted)) continue;
    instances_.push_back(i);
  }
  const auto parts = static_cast<uint32_t>(instances_.size());
  std::fill(part_of_instance_.begin(), part_of_instance_.end(), parts);
  for (uint32_t part = 0; part < parts; ++part) part_of_instance_[instances_[part]] = part;
}

// Neighbouring hits usually share instance and side.
void InsideLightReceiver::score(const Hits& hits, std::span<double> sums) const {
  const auto count = static_cast<size_t>(hits.count);
  for (size_t begin = 0, end = 0; begin < count; begin = end) {
    const uint32_t instance = hits.instance[begin];
    const uint8_t front = hits.front[begin];
    while (end < count && hits.instance[end] == instance && hits.front[end] == front) ++end;
    const size_t part = part_of_instance_[instance];
    if (part == instances_.size()) continue;
    double power_W = 0.0;
    for (size_t band = 0; band < static_cast<size_t>(hits.bands); ++band) {
      for (size_t i = begin; i < end; ++i) power_W += hits.incident_W[band][i];
    }
    sums[2 * part + (front != 0 ? 0 : 1)] += power_W;
  }
}

Estimate InsideLightReceiver::inside_W(const BinSums& sums) const {
  return sums.estimate([](std::span<const double> bins) {
    double sum = 0.0;
    for (size_t i = 1; i < bins.size(); i += 2) sum += bins[i];
    return sum;
  });
}

std::vector<InsideLightReceiver::Part> InsideLightReceiver::lit_inside(const BinSums& sums) const {
  std::vector<Part> lit;
  for (size_t part = 0; part < instances_.size(); ++part) {
    const Part found{instances_[part], sums.estimate(2 * part), sums.estimate(2 * part + 1)};
    if (found.inside_W.value > 0.0) lit.push_back(found);
  }
  std::stable_sort(lit.begin(), lit.end(), [](const Part& a, const Part& b) {
    return a.inside_W.value > b.inside_W.value;
  });
  return lit;
}

Product InsideLightReceiver::product(const BinSums& sums) const {
  return {{{"light_inside_closed_parts_W", inside_W(sums)}}, {}, {}, {}};
}

std::string describe_inside_light(const Scene& scene,
                                  const std::vector<InsideLightReceiver::Part>& lit,
                                  double emitted_W) {
  // A few of ten million rays may leak exactly at an edge; this fraction is ignored.
  constexpr double rounding = 1e-6;
  constexpr size_t max_named = 3;
  const auto percent = [&](double power_W) {
    const double value = 100.0 * power_W / emitted_W;
    return value < 10.0 ? printed("%.2g", value) : printed("%.0f", value);
  };
  double inside_W = 0.0;
  for (const auto& part : lit) inside_W += part.inside_W.value;
  if (inside_W <= rounding * emitted_W) return "";
  std::string line = percent(inside_W) + " % of the light falls on the inside of closed parts: ";
  for (size_t i = 0; i < std::min(lit.size(), max_named); ++i) {
    const bool turned = lit[i].inside_W.value > lit[i].outside_W.value;
    line += (i > 0 ? ", " : "") + scene.instances[lit[i].instance].path + " (" +
            percent(lit[i].inside_W.value) + " %, " +
            (turned ? "its triangles are turned inside out or a lamp stands in it" : "by cracks") +
            ")";
  }
  if (lit.size() > max_named) {
    line += " and " + std::to_string(lit.size() - max_named) + " more";
  }
  return line;
}

}  // namespace photorque
