#include "receivers/gather/open_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "receivers/gather/quadrature.h"

namespace photorque {
namespace {

// Mean of a function of the coordinates (a, b) over the triangle a, b ≥ 0, a + b ≤ 1. The error is
// the difference to a rule of degree 2.
// Source: A. H. Stroud, Approximate Calculation of Multiple Integrals (1971), T2: 2-1.
template <typename Function>
Integral<double> checked_mean(const Function& f) {
  const double mean = triangle_mean(f);
  return {mean, std::abs(mean - triangle_ring(f, 1.0 / 6.0) / 3.0)};
}

}  // namespace

void FluxEntries::add(double power_W, const GatherLamp& lamp, size_t bin, uint32_t instance,
                      std::span<double> entries) const {
  for (size_t band = 0; band < static_cast<size_t>(map_.bands().count()); ++band) {
    add(power_W * lamp.fraction()[band], band, bin, instance, entries);
  }
}

OpenLight::OpenLight(const GatherPlane& plane, const FluxEntries& flux)
    : plane_(plane), flux_(flux), tiles_(plane.grid()) {}

size_t OpenLight::add(const BinTile& tile, const Lamps& lamps, const OpenEntries& entries) const {
  LampSides sides;
  return add(tile, lamps, sides, entries);
}

size_t OpenLight::add(const BinTile& tile, const Lamps& lamps, LampSides& sides,
                      const OpenEntries& entries) const {
  const Ball ball = plane_.ball_of(tile);
  std::map<std::vector<size_t>, Lamps> smooth;  // lamps by numbers of points to try
  Lamps rest;
  for (const GatherLamp* lamp : lamps) {
    std::vector<size_t> attempts;
    if (lamp->smooth_over(ball)) {
      attempts = tiles_.attempts(tile, 2.0 * ball.radius_m / lamp->scale_m(ball));
    }
    (attempts.empty() ? rest : smooth[attempts]).push_back(lamp);
  }
  size_t open = 0;
  for (const auto& [attempts, some] : smooth) {
    if (const auto means = interpolate(tile, ball, attempts, some)) {
      open += add_smooth(tile, ball, *means, some, entries);
    } else {
      rest.insert(rest.end(), some.begin(), some.end());
    }
  }
  if (rest.empty()) return open;
  if (tile.count() == 1) {
    for (const GatherLamp* lamp : rest) open += add_bin(tile, ball, *lamp, sides[lamp], entries);
    return open;
  }
  for (const BinTile& half : tile.halves()) {
    Lamps lit;
    const Ball half_ball = plane_.ball_of(half);
    std::copy_if(rest.begin(), rest.end(), std::back_inserter(lit),
                 [&](const GatherLamp* lamp) { return !lamp->misses(half_ball); });
    if (!lit.empty()) open += add(half, lit, sides, entries);
  }
  return open;
}

std::optional<OpenLight::BandMeans> OpenLight::interpolate(const BinTile& tile, const Ball& ball,
                                                           std::span<const size_t> attempts,
                                                           const Lamps& lamps) const {
  double tolerance_W_m2 = 0.0;
  for (const GatherLamp* lamp : lamps) tolerance_W_m2 += tolerance * lamp->typical_W_m2(ball);
  const auto bands = static_cast<size_t>(plane_.bands().count());
  for (const size_t nodes : attempts) {
    const auto points = static_cast<Eigen::Index>(nodes);
    Eigen::MatrixXd one(points, points);
    BandMeans means(bands, {Eigen::MatrixXd::Zero(points, points), 0.0});
    for (const GatherLamp* lamp : lamps) {
      lamp->fill_irradiance(plane_, tile, tiles_.fractions(nodes), one);
      for (size_t band = 0; band < bands; ++band) {
        means[band].value += lamp->fraction()[band] * one;
      }
    }
    double error = 0.0;
    for (auto& band : means) {
      band.value = tiles_.means_of(tile, band.value, band.error);
      error += band.error;
    }
    if (error > tolerance_W_m2) continue;
    for (const GatherLamp* lamp : lamps) {
      for (size_t band = 0; band < bands; ++band) {
        means[band].error += lamp->fraction()[band] * lamp->table_error_W_m2();
      }
    }
    return means;
  }
  return std::nullopt;
}

size_t OpenLight::add_smooth(const BinTile& tile, const Ball& ball, const BandMeans& means,
                             const Lamps& lamps, const OpenEntries& entries) const {
  size_t open = 0;
  for (int row = 0; row < tile.rows; ++row) {
    for (int column = 0; column < tile.columns; ++column) {
      const size_t bin = plane_.bin_at(tile.column + column, tile.row + row);
      const auto patches = plane_.patches().of(bin);
      if (patches.empty()) continue;
      open += lamps.size();
      if (plane_.whole(bin)) {
        const SurfacePatch& patch = patches[0];
        for (size_t band = 0; band < means.size(); ++band) {
          const double power_W = patch.area_m2 * std::max(means[band].value(column, row), 0.0);
          flux_.add(power_W, band, bin, patch.instance, entries.power_W);
          flux_.add(patch.area_m2 * means[band].error, band, bin, patch.instance, entries.bound_W);
        }
        continue;
      }
      for (const SurfacePatch& patch : patches) {
        for (const GatherLamp* lamp : lamps) {
          const double tolerance_W_m2 = tolerance * lamp->typical_W_m2(ball);
          add_patch(power_on_smooth_W(patch, *lamp, tolerance_W_m2), patch, bin, *lamp, entries);
        }
      }
    }
  }
  return open;
}

// Integrates over a single bin along its outline.
size_t OpenLight::add_bin(const BinTile& tile, const Ball& ball, const GatherLamp& lamp,
                          Sides& sides, const OpenEntries& entries) const {
  const size_t bin = plane_.bin_at(tile.column, tile.row);
  const auto patches = plane_.patches().of(bin);
  const double tolerance_W_m2 = tolerance * lamp.typical_W_m2(ball);
  for (const SurfacePatch& patch : patches) {
    const Integral<double> power = plane_.whole(bin)
                                       ? power_W(tile.column, tile.row, lamp, tolerance_W_m2, sides)
                                       : power_W(patch, lamp, tolerance_W_m2);
    add_patch(power, patch, bin, lamp, entries);
  }
  return patches.empty() ? 0 : 1;
}

// Power on a patch of a tile with smooth irradiance.
Integral<double> OpenLight::power_on_smooth_W(const SurfacePatch& patch, const GatherLamp& lamp,
                                              double tolerance_W_m2) const {
  const auto irradiance = [&](double a, double b) {
    return lamp.irradiance_W_m2(patch.origin_m + a * patch.edge1_m + b * patch.edge2_m);
  };
  const Integral<double> mean = checked_mean(irradiance);
  if (!patch.triangle || mean.error > tolerance_W_m2) return power_W(patch, lamp, tolerance_W_m2);
  return {patch.area_m2 * mean.value, patch.area_m2 * (mean.error + lamp.table_error_W_m2())};
}

// Power on a patch, along its outline.
Integral<double> OpenLight::power_W(const SurfacePatch& patch, const GatherLamp& lamp,
                                    double tolerance_W_m2) const {
  const double tolerance_W =
      std::min(tolerance_W_m2 * patch.area_m2, tolerance * lamp.light().emitter().power_W());
  const Vec3& origin = patch.origin_m;
  if (lamp.light().parallel()) return {patch.area_m2 * lamp.irradiance_W_m2(origin), 0.0};
  std::array<Vec3, 4> corners = {origin, origin + patch.edge1_m, origin + patch.edge2_m, origin};
  if (patch.triangle) return lamp.power_W(std::span(corners).first(3), tolerance_W);
  corners = {origin, corners[1], corners[1] + patch.edge2_m, corners[2]};
  return lamp.power_W(corners, tolerance_W);
}

// Power on a whole bin, from its four sides.
Integral<double> OpenLight::power_W(int column, int row, const GatherLamp& lamp,
                                    double tolerance_W_m2, Sides& sides) const {
  const size_t bin = plane_.bin_at(column, row);
  const SurfacePatch& patch = plane_.patches().of(bin)[0];
  const auto corner = [&](int right, int up) {
    return lamp.emitter_from_body().point(plane_.point_m(column + right, row + up));
  };
  const std::array<Vec3, 4> corners = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
  const bool in_front = std::all_of(corners.begin(), corners.end(), [&](const Vec3& at) {
    return at.z() > lamp.light().lowest_m();
  });
  if (lamp.light().parallel() || !in_front) return power_W(patch, lamp, tolerance_W_m2);
  const double tolerance_W =
      0.25 * std::min(tolerance_W_m2 * patch.area_m2, tolerance * lamp.light().emitter().power_W());
  // A side from the corner of a bin to the right or upwards.
  const auto side = [&](int right, int up, bool upwards, const Vec3& from_m, const Vec3& to_m) {
    const uint64_t key = 2 * (static_cast<uint64_t>(row + up) * (max_grid_bins + 1) +
                              static_cast<uint64_t>(column + right)) +
                         (upwards ? 1 : 0);
    const auto [known, is_new] = sides.try_emplace(key);
    if (is_new) known->second = lamp.light().along_edge_W(from_m, to_m, tolerance_W);
    return known->second;
  };
  const auto bottom = side(0, 0, false, corners[0], corners[1]);
  const auto right = side(1, 0, true, corners[1], corners[2]);
  const auto top = side(0, 1, false, corners[3], corners[2]);
  const auto left = side(0, 0, true, corners[0], corners[3]);
  const double power = bottom.value + right.value - top.value - left.value;
  const Vec3 across = corners[1] - corners[0], along = corners[3] - corners[0];
  const bool mirrored = across.x() * along.y() < across.y() * along.x();
  return {mirrored ? -power : power, bottom.error + right.error + top.error + left.error};
}

void OpenLight::add_patch(const Integral<double>& power_W, const SurfacePatch& patch, size_t bin,
                          const GatherLamp& lamp, const OpenEntries& entries) const {
  const double positive_W = std::max(power_W.value, 0.0);  // a dark bin can be negative by rounding
  flux_.add(positive_W, lamp, bin, patch.instance, entries.power_W);
  flux_.add(power_W.error, lamp, bin, patch.instance, entries.bound_W);
}

}  // namespace photorque
