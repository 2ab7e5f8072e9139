// Shared by the tests of sources: keys that differ from an example, and rays from Sobol points.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/constants.h"
#include "core/files.h"
#include "core/numerics/random.h"
#include "raytrace/emitter.h"
#include "sources/photometry/ray_set.h"
#include "sources/profiles/tabulated_intensity.h"
#include "tests/outside.h"
#include "tests/settings.h"

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

// The keys of the kind's example with some replaced or added and
// some left out.
inline SettingsNode::Table changed(SettingsNode::Table table, SettingsNode::Table replacements,
                                   std::initializer_list<std::string> without = {}) {
  for (const std::string& key : without) table.erase(key);
  for (auto& [key, node] : replacements) table.insert_or_assign(key, std::move(node));
  return table;
}

// Keys of a typical source of each kind, for the laws that every source obeys.
inline SettingsNode::Table example_of(const std::string& kind) {
  const std::map<std::string, SettingsNode::Table> examples = {
      {"led",
       {{"power_W", {2.0}},
        {"aperture_diameter_m", {0.02}},
        {"profile", {"gaussian"}},
        {"fwhm_deg", {3.0}},
        {"halo_fraction", {0.2}},
        {"halo_fwhm_deg", {12.0}},
        {"wavelength_nm", {730.0}},
        {"position_m", vector_node(0.0, 0.0, 1.5)},
        {"aim_m", vector_node(0.0, 0.0, 0.0)}}},
      {"led_array",
       {{"layout", {"ring"}},
        {"count", {int64_t{6}}},
        {"ring_radius_m", {0.2}},
        {"position_m", vector_node(0.0, 0.0, 1.5)},
        {"aim", {"converging"}},
        {"aim_m", vector_node(0.0, 0.0, 0.0)},
        {"total_power_W", {90.0}},
        {"aperture_diameter_m", {0.03}},
        {"profile", {"super_gaussian"}},
        {"fwhm_deg", {3.0}},
        {"order", {4.0}},
        {"wavelength_nm", {730.0}}}},
      {"laser",
       {{"power_W", {0.005}},
        {"wavelength_nm", {633.0}},
        {"waist_radius_m", {0.0005}},
        {"divergence_half_angle_deg", {0.1}},
        {"position_m", vector_node(0.0, 0.0, 1.5)},
        {"direction", vector_node(0.0, 0.0, -1.0)}}},
      {"sun", {{"direction", vector_node(0.3, 0.0, -1.0)}}},
      {"solar_simulator",
       {{"footprint_diameter_m", {0.6}},
        {"collimation_half_angle_deg", {2.0}},
        {"nonuniformity", {0.05}},
        {"position_m", vector_node(0.0, 0.0, 0.0)},
        {"direction", vector_node(0.3, 0.0, -1.0)}}},
      {"ies",
       {{"polar_deg", {SettingsNode::Array{{0.0}, {5.0}, {10.0}, {20.0}, {40.0}, {90.0}}}},
        {"intensity", {SettingsNode::Array{{1.0}, {0.9}, {0.6}, {0.2}, {0.05}, {0.0}}}},
        {"power_W", {2.0}},
        {"aperture_diameter_m", {0.02}},
        {"wavelength_nm", {730.0}},
        {"position_m", vector_node(0.0, 0.0, 1.5)},
        {"direction", vector_node(0.0, 0.0, -1.0)}}},
      {"ray_file",
       {{"file", {"lamp.tm25ray"}},
        {"power_W", {2.0}},
        {"wavelength_nm", {730.0}},
        {"position_m", vector_node(0.0, 0.0, 1.5)},
        {"direction", vector_node(0.0, 0.0, -1.0)}}},
  };
  return examples.at(kind);
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
    sobol_points({seed, 0, 0}, first, samples->columns());
    emitter.emit(*samples, *block);
    for (size_t i = 0; i < ray_block; ++i) {
      rays.push_back({block->origin_at_m(i), block->direction_at(i)});
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
  const auto lamp = make_beams("led", example_of("led")).front().emitter;
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
