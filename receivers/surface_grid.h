// A regular grid of bins on part of a scene, the area of surface in every bin, and maps of values
// on the grid.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/errors.h"
#include "core/product.h"
#include "core/transform.h"
#include "raytrace/scene.h"

namespace photorque {

// Side of a surface that counts. `both` adds the light on both sides and divides by the area of
// one, as the irradiance of a bifacial sheet.
enum class Side { front, back, both };

// A triangle of the scene in the body frame. `area_body_m2` points to the front; its length is the
// area.
struct SurfaceFace {
  uint32_t instance = 0;
  uint32_t triangle = 0;
  std::array<Vec3, 3> corner_body_m;
  Vec3 area_body_m2 = Vec3::Zero();
};

// Triangles of some instances; with `facing_body`, only those whose front is turned towards that
// direction (by less than 90 deg).
std::vector<SurfaceFace> faces_of(const Scene& scene, std::span<const uint32_t> instances,
                                  const std::optional<Vec3>& facing_body = std::nullopt);

// Positions of the bins, and the faces that count.
struct SurfaceGrid {
  // plane:   bins are squares of a plane, seen along `normal_body`; coordinates u, v in metres are
  //          the components of the position along u_axis_body and v_axis_body.
  // texture: bins are squares of the texture coordinates, u and v in [0, 1].
  enum class Over { plane, texture };

  Over over = Over::plane;
  Side side = Side::front;
  std::optional<Vec3> facing_body;
  std::vector<uint32_t> instances;

  // plane only: right-handed and orthonormal, v = normal × u.
  Vec3 normal_body = Vec3::UnitZ();
  Vec3 u_axis_body = Vec3::UnitX();
  Vec3 v_axis_body = Vec3::UnitY();

  int width = 0;                                        // bins along u
  int height = 0;                                       // bins along v
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;  // outer edges

  // Area of surface (one side) per bin, bin = iv · width + iu; exact to 1e-12 of the total. Zero
  // where there is no surface.
  std::vector<double> area_m2;

  // plane only: area of overlapping layers of the surface, seen along the normal. Layers above each
  // other share bins, which add up their light and area.
  double overlapping_m2 = 0.0;

  size_t bins() const { return area_m2.size(); }
  // Index of the bin in a column and row.
  size_t bin_at(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(column);
  }
  // Sum of area_m2.
  double total_area_m2() const;
};

struct SurfaceGridOptions {
  SurfaceGrid::Over over = SurfaceGrid::Over::plane;
  Side side = Side::front;
  int width = 100;   // 1 … 4096
  int height = 100;  // 1 … 4096
  // Keep only faces turned towards this direction and look along it. Required for closed bodies,
  // whose mean normal is zero.
  std::optional<Vec3> facing_body;
  // Name of the surface in error messages.
  InputLocation where;
  std::string key = "receiver";
};

inline constexpr int max_grid_bins = 4096;  // per direction

// Makes a grid over the instances. Over a plane, the normal is `facing_body`, by default the
// area-weighted mean normal. u is the projection of body x (of body y if the normal is within 1e-6
// rad of ±x). The extent is the bounding rectangle of all faces.
// Throws InputError if there is no surface, if a closed surface lacks `facing_body`, or if a mesh
// lacks texture coordinates or has some outside [0, 1].
SurfaceGrid make_surface_grid(const Scene& scene, std::span<const uint32_t> instances,
                              const SurfaceGridOptions& options);

// Index of the bin of a point of the body frame (over a plane) or of texture coordinates (over a
// texture); the nearest bin for points outside.
size_t bin_of_position(const SurfaceGrid& grid, const Vec3& position_body_m);
size_t bin_of_texture(const SurfaceGrid& grid, const Vec2& uv);

// Corners of a face on the grid, in units of bins from its lower corner.
std::array<Vec2, 3> corners_in_bins(const SurfaceGrid& grid, const Scene& scene,
                                    const SurfaceFace& face);

// Texture coordinates of the corners of a face.
std::array<Vec2, 3> texture_corners(const Scene& scene, const SurfaceFace& face);

// Cuts a triangle along the lines of a grid of unit cells [0, width] × [0, height]. Calls
// `add(column, row, fraction)` with the fraction of the triangle's area in each cell. The fractions
// are ≥ 0 and sum to 1 within a few roundings, also for a triangle that is edge-on to the grid.
// `corners` are in units of cells; parts outside count for the nearest cell.
//
// Method: divide_convex(), first into columns and then into rows. The polygons carry barycentric
// coordinates, from which areas are computed.
void split_over_cells(const std::array<Vec2, 3>& corners, int width, int height,
                      const std::function<void(int, int, double)>& add);

// As split_over_cells(), but calls add(column, row, corners of a convex polygon) with the pieces.
// Each corner is given by its weights of the triangle's corners 1 and 2.
void clip_to_cells(const std::array<Vec2, 3>& corners, int width, int height,
                   const std::function<void(int, int, std::span<const Vec2>)>& add);

// A Map with one estimate per bin, and the grid's edges and labels. Over a plane, an axis along a
// body axis has its name.
Map grid_map(const SurfaceGrid& grid, const std::vector<Estimate>& bins, const std::string& name,
             const std::string& title, const std::string& unit);

}  // namespace photorque
