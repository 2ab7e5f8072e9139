#include "photovoltaics/array/places.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "core/numerics/connected.h"
#include "core/numerics/order.h"
#include "photovoltaics/array/keys.h"
#include "receivers/surface_grid.h"

namespace photorque {
namespace {

using FacePiece = std::vector<SurfaceFace>;

// Numbers corners. Corners that differ by rounding only (1e-7 of the extent) have one number.
class CornerNames {
 public:
  explicit CornerNames(double extent_m) : step_m_(std::max(1e-7 * extent_m, 1e-12)) {}
  int of(const Vec3& at_m) {
    // Neighbouring boxes are searched too, for corners that rounding put on either side of a
    // boundary.
    const std::array<int64_t, 3> box = {nearest(at_m.x()), nearest(at_m.y()), nearest(at_m.z())};
    for (int64_t i = -1; i <= 1; ++i) {
      for (int64_t j = -1; j <= 1; ++j) {
        for (int64_t k = -1; k <= 1; ++k) {
          const auto known = names_.find({box[0] + i, box[1] + j, box[2] + k});
          if (known != names_.end()) return known->second;
        }
      }
    }
    return names_[box] = static_cast<int>(names_.size());
  }

 private:
  int64_t nearest(double x) const { return std::llround(x / step_m_); }
  double step_m_;
  std::map<std::array<int64_t, 3>, int> names_;
};

// Groups the faces of one instance that are connected by shared edges.
std::vector<FacePiece> connected_pieces(const std::vector<SurfaceFace>& faces) {
  double extent_m = 0.0;
  for (const SurfaceFace& face : faces) {
    for (const Vec3& corner : face.corner_body_m) extent_m = std::max(extent_m, corner.norm());
  }
  CornerNames names(extent_m);
  DisjointSets sets(faces.size());
  std::map<std::pair<int, int>, size_t> face_at_edge;
  for (size_t f = 0; f < faces.size(); ++f) {
    for (size_t i = 0; i < 3; ++i) {
      const std::pair<int, int> edge = std::minmax(names.of(faces[f].corner_body_m[i]),
                                                   names.of(faces[f].corner_body_m[(i + 1) % 3]));
      const auto [known, added] = face_at_edge.emplace(edge, f);
      if (!added) sets.join(known->second, f);
    }
  }
  std::map<size_t, FacePiece> pieces;
  for (size_t f = 0; f < faces.size(); ++f) pieces[sets.root(f)].push_back(faces[f]);
  std::vector<FacePiece> all;
  for (auto& [root, piece] : pieces) all.push_back(std::move(piece));
  return all;
}

struct FoundCell {
  std::vector<BinPart> parts;
  Vec2 centre;  // in bins
  Vec2 size;
};

FoundCell found_cell(const FacePiece& piece, const Scene& scene, const SurfaceGrid& grid) {
  FoundCell cell;
  std::map<uint32_t, double> area_m2;
  double total_m2 = 0.0;
  Vec2 moment = Vec2::Zero();
  Vec2 low = Vec2::Constant(1e300), high = Vec2::Constant(-1e300);
  for (const SurfaceFace& face : piece) {
    const double face_m2 = face.area_body_m2.norm();
    const std::array<Vec2, 3> corners = corners_in_bins(grid, scene, face);
    total_m2 += face_m2;
    moment += face_m2 / 3.0 * (corners[0] + corners[1] + corners[2]);
    for (const Vec2& corner : corners) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    split_over_cells(corners, grid.width, grid.height, [&](int column, int row, double fraction) {
      area_m2[static_cast<uint32_t>(row * grid.width + column)] += fraction * face_m2;
    });
  }
  for (const auto& [bin, part_m2] : area_m2) {
    if (grid.area_m2[bin] > 0.0) cell.parts.push_back({bin, part_m2 / grid.area_m2[bin]});
  }
  cell.centre = moment / total_m2;
  cell.size = high - low;
  return cell;
}

// The rank of each number among the distinct numbers, and the count of these. Numbers closer than
// `apart` count as equal.
std::pair<std::vector<int>, int> ranks(const std::vector<double>& numbers, double apart) {
  const std::vector<size_t> order =
      sorted_indices(numbers.size(), [&](size_t a, size_t b) { return numbers[a] < numbers[b]; });
  std::vector<int> rank(numbers.size(), 0);
  int last = 0;
  for (size_t k = 1; k < order.size(); ++k) {
    if (numbers[order[k]] - numbers[order[k - 1]] > apart) ++last;
    rank[order[k]] = last;
  }
  return {rank, last + 1};
}

// Sorts cells on a lattice of columns and rows, with one cell at every crossing, and returns
// {columns, rows}; {count, 1} if they are not on a lattice.
std::pair<int, int> sort_lattice(std::vector<FoundCell>& cells) {
  std::vector<double> u, v;
  Vec2 least = Vec2::Constant(1e300);
  for (const FoundCell& cell : cells) {
    u.push_back(cell.centre.x());
    v.push_back(cell.centre.y());
    least = least.cwiseMin(cell.size);
  }
  const auto [column, columns] = ranks(u, 0.25 * least.x());
  const auto [row, rows] = ranks(v, 0.25 * least.y());
  const std::pair<int, int> none = {static_cast<int>(cells.size()), 1};
  if (static_cast<size_t>(columns) * static_cast<size_t>(rows) != cells.size()) return none;
  std::vector<FoundCell> sorted(cells.size());
  std::vector<char> taken(cells.size(), 0);
  for (size_t i = 0; i < cells.size(); ++i) {
    const auto place =
        static_cast<size_t>(row[i]) * static_cast<size_t>(columns) + static_cast<size_t>(column[i]);
    if (taken[place] != 0) return none;
    taken[place] = 1;
    sorted[place] = cells[i];
  }
  cells = std::move(sorted);
  return {columns, rows};
}

Vec2 read_corner(const Settings& rectangle, const char* key) {
  const std::vector<double> uv = rectangle.numbers(key);
  if (uv.size() != 2) {
    throw rectangle.error(key, std::to_string(uv.size()) + " numbers", "[u, v]");
  }
  return {uv[0], uv[1]};
}

CellRectangle read_rectangle(const Settings& settings, const SurfaceGrid& grid) {
  const Vec2 low = read_corner(settings, "low_m"), high = read_corner(settings, "high_m");
  const double slack_u = 1e-9 * (grid.u_high - grid.u_low);
  const double slack_v = 1e-9 * (grid.v_high - grid.v_low);
  const bool inside = low.x() >= grid.u_low - slack_u && low.y() >= grid.v_low - slack_v &&
                      high.x() <= grid.u_high + slack_u && high.y() <= grid.v_high + slack_v;
  if (!inside || !(high.x() > low.x()) || !(high.y() > low.y())) {
    const auto range = [](double from, double to) {
      return std::to_string(from) + " to " + std::to_string(to);
    };
    throw settings.error(array_key::high,
                         range(low.x(), high.x()) + " by " + range(low.y(), high.y()),
                         "a rectangle within u = " + range(grid.u_low, grid.u_high) +
                             ", v = " + range(grid.v_low, grid.v_high));
  }
  return {low.x(), high.x(), low.y(), high.y()};
}

bool overlapping(const CellRectangle& a, const CellRectangle& b) {
  constexpr double rounding = 1e-9;
  return std::min(a.u_high, b.u_high) - std::max(a.u_low, b.u_low) >
             rounding * (a.u_high - a.u_low) &&
         std::min(a.v_high, b.v_high) - std::max(a.v_low, b.v_low) >
             rounding * (a.v_high - a.v_low);
}

}  // namespace

CellPlaces places_from_mesh(const Scene& scene, const SurfaceGrid& grid) {
  std::vector<FoundCell> cells;
  for (const uint32_t instance : grid.instances) {
    for (const FacePiece& piece :
         connected_pieces(faces_of(scene, {{instance}}, grid.facing_body))) {
      cells.push_back(found_cell(piece, scene, grid));
    }
  }
  const auto [columns, rows] = sort_lattice(cells);
  CellPlaces places{{}, {}, columns, rows};
  for (FoundCell& cell : cells) {
    places.parts.push_back(std::move(cell.parts));
    places.centres.emplace_back(
        grid.u_low + cell.centre.x() * (grid.u_high - grid.u_low) / grid.width,
        grid.v_low + cell.centre.y() * (grid.v_high - grid.v_low) / grid.height);
  }
  return places;
}

CellPlaces places_from_rectangles(std::span<const CellRectangle> cells, const SurfaceGrid& grid) {
  CellPlaces places{{}, {}, static_cast<int>(cells.size()), 1};
  for (const CellRectangle& cell : cells) {
    places.parts.push_back(parts_of_rectangle(cell, grid));
    places.centres.emplace_back(std::midpoint(cell.u_low, cell.u_high),
                                std::midpoint(cell.v_low, cell.v_high));
  }
  return places;
}

std::optional<CellPlaces> read_cell_places(const Settings& array, const Scene& scene,
                                           const SurfaceGrid& grid) {
  const bool mesh = array.has(array_key::cells) &&
                    std::holds_alternative<std::string>(array.raw(array_key::cells).value);
  const bool rectangles = array.has(array_key::rectangle);
  if (!mesh && !rectangles) return std::nullopt;
  if (rectangles && array.has(array_key::cells)) {
    throw array.error(array_key::cells, "rectangles too", "cells or [[array.rectangle]]");
  }
  for (const char* key : {"gap_m", "margin_m"}) {
    if (array.has(key)) throw array.error(key, "places of the cells too", "one of the two");
  }
  if (mesh) {
    array.choice(array_key::cells, {"mesh"});
    return places_from_mesh(scene, grid);
  }
  std::vector<CellRectangle> cells;
  for (const Settings& rectangle : array.get(array_key::rectangle)) {
    const CellRectangle cell = read_rectangle(rectangle, grid);
    const auto other = std::ranges::find_if(
        cells, [&](const CellRectangle& known) { return overlapping(cell, known); });
    if (other != cells.end()) {
      throw rectangle.error(array_key::low,
                            "a cell over cell " + std::to_string(other - cells.begin()),
                            "cells beside each other");
    }
    cells.push_back(cell);
  }
  return places_from_rectangles(cells, grid);
}

}  // namespace photorque
