#include "receivers/gather/bodies/partition.h"

#include <algorithm>
#include <cmath>

#include "core/numerics/divide_convex.h"

namespace photorque {
namespace {

constexpr double touching = 1e-9;  // of a cell: traces this close to its side count as outside
constexpr size_t few = 4;          // maximum number of lines that cut one cell

// Keeps one of several traces on the same line.
void thin_out(std::vector<Trace>& traces) {
  const auto on_line = [](const Trace& one, const Trace& other) {
    const Vec2 p(one.from[1], one.from[2]), along = Vec2(one.to[1], one.to[2]) - p;
    const auto distance = [&](const CornerWeights& w) {
      return std::abs(along.y() * (w[1] - p.x()) - along.x() * (w[2] - p.y())) / along.norm();
    };
    return distance(other.from) < touching && distance(other.to) < touching;
  };
  for (size_t i = 0; i < traces.size(); ++i) {
    const auto rest = traces.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    traces.erase(std::remove_if(rest, traces.end(),
                                [&](const Trace& other) { return on_line(traces[i], other); }),
                 traces.end());
  }
}

// A convex part of a cell, in the weights of the corners 1 and 2.
class Polygon {
 public:
  static Polygon whole() {
    Polygon all;
    all.corner_ = {Vec2(0.0, 0.0), Vec2(1.0, 0.0), Vec2(0.0, 1.0)};
    all.count_ = 3;
    return all;
  }
  // Parts on either side of the line through `from` and `to`.
  std::array<Polygon, 2> split(const Vec2& from, const Vec2& to) const {
    const Vec2 along = to - from;
    const auto side_of = [&](const Vec2& p) {
      return along.x() * (p.y() - from.y()) - along.y() * (p.x() - from.x());
    };
    std::array<Polygon, 2> halves;
    divide_convex(std::span(corner_).first(count_), side_of, [&](const Vec2& p, double side) {
      if (side >= 0.0) halves[0].add(p);
      if (side <= 0.0) halves[1].add(p);
    });
    return halves;
  }
  // Area as a fraction of the cell.
  double share() const {
    double sum = 0.0;
    for (size_t i = 1; i + 1 < count_; ++i) sum += twice_area(i);
    return sum;
  }
  CornerWeights centre() const {
    Vec2 sum = Vec2::Zero();
    for (size_t i = 1; i + 1 < count_; ++i) {
      sum += twice_area(i) * (corner_[0] + corner_[i] + corner_[i + 1]) / 3.0;
    }
    sum /= share();
    return {1.0 - sum.x() - sum.y(), sum.x(), sum.y()};
  }

 private:
  void add(const Vec2& p) {
    if (count_ < corner_.size()) corner_[count_++] = p;  // more corners only by rounding
  }
  double twice_area(size_t i) const {
    const Vec2 a = corner_[i] - corner_[0], b = corner_[i + 1] - corner_[0];
    return a.x() * b.y() - a.y() * b.x();
  }

  std::array<Vec2, 3 + 2 * few> corner_;
  size_t count_ = 0;
};

void cut_along(const Cell& cell, std::span<const Trace> traces, std::vector<Piece>& pieces) {
  constexpr double nothing = 1e-12;
  std::vector<Polygon> parts = {Polygon::whole()}, next;
  for (const Trace& trace : traces) {
    next.clear();
    for (const Polygon& part : parts) {
      for (const Polygon& half :
           part.split({trace.from[1], trace.from[2]}, {trace.to[1], trace.to[2]})) {
        if (half.share() > nothing) next.push_back(half);
      }
    }
    std::swap(parts, next);
  }
  for (const Polygon& part : parts) {
    pieces.push_back({cell, part.share() * cell.share(), cell.at(part.centre()), false});
  }
}

// Whether a trace lies outside a quarter, beyond the side that the quarter shares with others.
bool beside(const Trace& trace, uint32_t which) {
  const auto both = [&](int k, const auto& hold) {
    return hold(trace.from[k]) && hold(trace.to[k]);
  };
  if (which < 3) return both(static_cast<int>(which), [](double w) { return w <= 0.5; });
  const auto high = [](double w) { return w >= 0.5; };
  return both(0, high) || both(1, high) || both(2, high);
}

// Cuts cells into quarters until they are small enough for the traces that cross them.
class Descent {
 public:
  Descent(std::span<const Trace> traces, const Levels& levels, uint32_t deepest,
          std::vector<Piece>& pieces)
      : traces_(traces.begin(), traces.end()),
        levels_(levels),
        deepest_(deepest),
        pieces_(pieces) {}

  // Processes a cell. Its traces are those from `begin` on; they are removed afterwards.
  void run(const Cell& cell, size_t begin) {
    const size_t count = traces_.size() - begin;
    const bool fine = cell.level >= (count == 0 ? levels_.finest : levels_.along_traces);
    if (fine && (count == 0 || cell.level >= deepest_)) {
      pieces_.push_back({cell, cell.share(), cell.centre(), true});
      return;
    }
    if (fine && count <= 4 * few) {
      // A cell is cut along whole lines, so the ends of a trace on its line do not matter.
      lines_.assign(traces_.begin() + static_cast<std::ptrdiff_t>(begin), traces_.end());
      thin_out(lines_);
      if (lines_.size() <= few) {
        cut_along(cell, lines_, pieces_);
        return;
      }
    }
    const size_t end = traces_.size();
    for (uint32_t q = 0; q < 4; ++q) {
      for (size_t i = begin; i < end; ++i) {
        if (beside(traces_[i], q)) continue;
        const Trace own = in_quarter(traces_[i], q);
        if (meets(own, -touching)) traces_.push_back(own);
      }
      run(cell.quarter(q), end);
      traces_.resize(end);
    }
  }

 private:
  std::vector<Trace> traces_;  // of the current cell, after those of the cells that contain it
  std::vector<Trace> lines_;
  Levels levels_;
  uint32_t deepest_;
  std::vector<Piece>& pieces_;
};

}  // namespace

Screen::Screen(const Facet& facet) : area_m2_(facet.area_m2), corner_m_(facet.corner_m[0]) {
  const Vec3 e1 = facet.corner_m[1] - corner_m_, e2 = facet.corner_m[2] - corner_m_;
  const double a = e1.dot(e1), b = e1.dot(e2), c = e2.dot(e2), d = e1.cross(e2).squaredNorm();
  u_per_m_ = (c * e1 - b * e2) / d;
  v_per_m_ = (a * e2 - b * e1) / d;
}

void Screen::add(std::span<const Line> lines, const Vec3& normal, const Vec3& travel,
                 double rounding_m) {
  // (u, v) of a point that is moved along the light onto the facet's plane.
  const Vec3 per_fall = normal / normal.dot(travel);
  const Vec3 to_u = u_per_m_ - u_per_m_.dot(travel) * per_fall;
  const Vec3 to_v = v_per_m_ - v_per_m_.dot(travel) * per_fall;
  const auto weights = [&](const Vec3& p) {
    const double u = to_u.dot(p), v = to_v.dot(p);
    return CornerWeights(1.0 - u - v, u, v);
  };
  for (const Line& line : lines) {
    Vec3 from = line.from_m - corner_m_, to = line.to_m - corner_m_;
    const double high = normal.dot(from), higher = normal.dot(to);
    if (high < -rounding_m && higher < -rounding_m) continue;
    if (high < -rounding_m) from += high / (high - higher) * (to - from);
    if (higher < -rounding_m) to += higher / (higher - high) * (from - to);
    const double height_m = std::max(0.0, std::min(normal.dot(from), normal.dot(to)));
    const Trace trace{weights(from), weights(to), height_m};
    if (meets(trace, -touching)) traces_.push_back(trace);
  }
}

void Screen::cut(Levels levels, double least_m2, std::vector<Piece>& pieces) const {
  const double times = 0.5 * std::log2(area_m2_ / least_m2);
  const auto deepest = static_cast<uint32_t>(std::clamp(std::ceil(times), 0.0, 14.0));
  levels.along_traces = std::max(levels.along_traces, levels.finest);
  Descent(traces_, levels, std::max(levels.along_traces, deepest), pieces).run({}, 0);
}

}  // namespace photorque
