#include "receivers/surface_clip.h"

#include <algorithm>
#include <cmath>

namespace photorque {
namespace {

// A corner of a clipped piece: where it is on the grid, and where in the triangle.
struct Corner {
  Vec2 cell = Vec2::Zero();
  Vec2 barycentric = Vec2::Zero();
};

// A triangle cut by four lines has at most seven corners; the rest is room for rounding.
struct Piece {
  std::array<Corner, 12> corner;
  size_t count = 0;

  void add(const Corner& c) { corner[count++] = c; }
};

struct Halves {
  Piece below;
  Piece above;
};

Halves cut(const Piece& piece, int axis, double at) {
  Halves halves;
  for (size_t i = 0; i < piece.count; ++i) {
    const Corner& a = piece.corner[i];
    const Corner& b = piece.corner[i + 1 == piece.count ? 0 : i + 1];
    const double from = a.cell[axis] - at, to = b.cell[axis] - at;
    if (from <= 0) halves.below.add(a);
    if (from >= 0) halves.above.add(a);
    if ((from < 0 && to > 0) || (from > 0 && to < 0)) {
      const double t = from / (from - to);
      Corner crossing{a.cell + t * (b.cell - a.cell),
                      a.barycentric + t * (b.barycentric - a.barycentric)};
      crossing.cell[axis] = at;
      halves.below.add(crossing);
      halves.above.add(crossing);
    }
  }
  return halves;
}

// Of the whole triangle, whose barycentric coordinates enclose an area of one half.
double area_fraction(std::span<const Vec2> piece) {
  double twice_area = 0.0;
  for (size_t i = 2; i < piece.size(); ++i) {
    const Vec2 a = piece[i - 1] - piece[0];
    const Vec2 b = piece[i] - piece[0];
    twice_area += a.x() * b.y() - a.y() * b.x();
  }
  return std::max(0.0, twice_area);
}

// Calls take(index, part) for the parts of a piece between whole numbers along an axis.
template <typename Take>
void slice(Piece rest, int axis, int size, const Take& take) {
  double low = rest.corner[0].cell[axis], high = low;
  for (size_t i = 1; i < rest.count; ++i) {
    low = std::min(low, rest.corner[i].cell[axis]);
    high = std::max(high, rest.corner[i].cell[axis]);
  }
  const auto index = [size](double x) {
    return static_cast<int>(std::clamp(std::floor(x), 0.0, size - 1.0));
  };
  // A piece that is edge-on to this axis is not cut: which side of a line its corners round to
  // means nothing.
  const int first = index(low);
  const int last = high - low < 1e-9 ? first : index(high);
  for (int i = first; i < last; ++i) {
    Halves halves = cut(rest, axis, i + 1.0);
    if (halves.below.count >= 3) take(i, halves.below);
    rest = halves.above;
  }
  if (rest.count >= 3) take(last, rest);
}

}  // namespace

void clip_to_cells(const std::array<Vec2, 3>& corners, int width, int height,
                   const std::function<void(int, int, std::span<const Vec2>)>& add) {
  Piece triangle;
  triangle.add({corners[0], {0, 0}});
  triangle.add({corners[1], {1, 0}});
  triangle.add({corners[2], {0, 1}});
  slice(triangle, 0, width, [&](int column, const Piece& strip) {
    slice(strip, 1, height, [&](int row, const Piece& part) {
      std::array<Vec2, 12> weights;
      for (size_t i = 0; i < part.count; ++i) weights[i] = part.corner[i].barycentric;
      add(column, row, std::span(weights).first(part.count));
    });
  });
}

void split_over_cells(const std::array<Vec2, 3>& corners, int width, int height,
                      const std::function<void(int, int, double)>& add) {
  clip_to_cells(corners, width, height, [&](int column, int row, std::span<const Vec2> piece) {
    add(column, row, area_fraction(piece));
  });
}

}  // namespace photorque
