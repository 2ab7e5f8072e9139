// Shared by the tests of sources: settings made by hand, and rays from Sobol points.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/constants.h"
#include "core/files.h"
#include "core/numerics/random.h"
#include "core/settings/settings.h"
#include "raytrace/emitter.h"
#include "sources/lamps/kind.h"
#include "sources/photometry/ray_set.h"
#include "sources/profiles/tabulated_intensity.h"
#include "tests/outside.h"

namespace photorque {

inline constexpr double deg = degree_rad;

namespace test {

// Where the sample files of photometers and lamp makers lie, if they are there.
inline std::filesystem::path samples() {
  return outside::third_party("photometry");
}

// The direction in the emitter's frame with these coordinates: the inverse of table_angles().
inline Vec3 table_direction(Pole pole, double polar_rad, double azimuth_rad) {
  const double across = std::sin(polar_rad) * std::cos(azimuth_rad);
  const double up = std::sin(polar_rad) * std::sin(azimuth_rad), along = std::cos(polar_rad);
  switch (pole) {
    case Pole::vertical:
      return {along, up, across};
    case Pole::horizontal:
      return {up, along, across};
    case Pole::beam:
      break;
  }
  return {across, -up, along};
}

inline SettingsNode vector_node(double x, double y, double z) {
  return {SettingsNode::Array{{x}, {y}, {z}}, {}};
}

inline void set_location(SettingsNode& node, const InputLocation& where) {
  node.where = where;
  if (auto* table = std::get_if<SettingsNode::Table>(&node.value)) {
    for (auto& [key, inner] : *table) set_location(inner, where);
  } else if (auto* array = std::get_if<SettingsNode::Array>(&node.value)) {
    for (SettingsNode& inner : *array) set_location(inner, where);
  }
}

// As if read from line 7 of test.toml.
inline Settings settings_of(SettingsNode::Table table) {
  SettingsNode root{std::move(table)};
  set_location(root, {"test.toml", 7});
  return Settings(std::make_shared<SettingsNode>(std::move(root)), "source[0]");
}

inline SourceKind kind_called(const std::string& name) {
  for (SourceKind& kind : all_source_kinds()) {
    if (kind.name == name) return kind;
  }
  throw std::logic_error("no source kind " + name);
}

// The keys of the kind's example with some replaced or added and some left out.
inline SettingsNode::Table changed(SettingsNode::Table table, SettingsNode::Table replacements,
                                   std::initializer_list<std::string> without = {}) {
  for (const std::string& key : without) table.erase(key);
  for (auto& [key, node] : replacements) table.insert_or_assign(key, std::move(node));
  return table;
}

inline std::vector<Beam> make_beams(const std::string& kind, SettingsNode::Table table,
                                    const SourceContext& context = {}) {
  const Settings settings = settings_of(std::move(table));
  std::vector<Beam> beams = kind_called(kind).make(settings, context);
  settings.finish();
  return beams;
}

struct Ray {
  Vec3 origin_m;
  Vec3 direction;
};

// The first `count` (a multiple of the block) rays of an emitter, in its own frame.
inline std::vector<Ray> rays_of(const Emitter& emitter, uint32_t count, uint64_t seed = 1) {
  auto samples = std::make_unique<SampleBlock>();
  auto block = std::make_unique<RayBlock>();
  std::vector<Ray> rays;
  rays.reserve(count);
  for (uint32_t first = 0; first < count; first += ray_block) {
    sobol_points({seed, 0, 0}, first,
                 {samples->bits[0].data(), samples->bits[1].data(), samples->bits[2].data(),
                  samples->bits[3].data()});
    emitter.emit(*samples, *block);
    for (int i = 0; i < ray_block; ++i) {
      rays.push_back({{block->origin_m[0][i], block->origin_m[1][i], block->origin_m[2][i]},
                      {block->direction[0][i], block->direction[1][i], block->direction[2][i]}});
    }
  }
  return rays;
}

// A context whose folder holds the file that an example may name: even rays of a Gaussian lamp.
inline SourceContext with_files() {
  // A folder for each test: they may run side by side.
  const auto* running = testing::UnitTest::GetInstance()->current_test_info();
  SourceContext context;
  context.folder = std::filesystem::path(testing::TempDir()) /
                   (std::string(running->test_suite_name()) + "_" + running->name());
  const std::filesystem::path file = context.folder / "lamp.tm25ray";
  if (std::filesystem::exists(file)) return context;
  RaySet set;
  const auto lamp = make_beams("led", kind_called("led").example).front().emitter;
  for (const Ray& ray : rays_of(*lamp, 65536)) {
    set.rays.push_back({ray.origin_m, ray.direction, 1.0, 0.0});
  }
  write_file_whole(file, write_tm25(set));
  return context;
}

// Angles from +z, ascending.
inline std::vector<double> sorted_angles(const std::vector<Ray>& rays) {
  std::vector<double> angles;
  for (const Ray& ray : rays) {
    angles.push_back(
        std::atan2(std::hypot(ray.direction.x(), ray.direction.y()), ray.direction.z()));
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

// The largest distance between the distribution of sorted samples and a cumulative distribution
// (the statistic of Kolmogorov and Smirnov).
template <typename Cumulative>
double largest_deviation(const std::vector<double>& sorted, const Cumulative& cumulative) {
  double largest = 0.0;
  const auto n = static_cast<double>(sorted.size());
  for (size_t i = 0; i < sorted.size(); ++i) {
    const double expected = cumulative(sorted[i]);
    largest = std::max({largest, std::abs(static_cast<double>(i) / n - expected),
                        std::abs(static_cast<double>(i + 1) / n - expected)});
  }
  return largest;
}

}  // namespace test
}  // namespace photorque
