#include "receivers/gather/bodies/outlines.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "receivers/gather/bodies/partition.h"

namespace photorque {
namespace {

// The instance of an edge and its ends in a fixed order. Corners of one mesh are transformed
// identically, so that equal corners have equal bits.
using EdgeKey = std::array<double, 7>;

EdgeKey key_of(uint32_t instance, const Vec3& a, const Vec3& b) {
  const bool turned = std::lexicographical_compare(b.data(), b.data() + 3, a.data(), a.data() + 3);
  EdgeKey key{static_cast<double>(instance)};
  std::copy_n((turned ? b : a).data(), 3, &key[1]);
  std::copy_n((turned ? a : b).data(), 3, &key[4]);
  return key;
}

// Lines at which other facets cut through a facet.
std::vector<Line> cuts_through(const Facet& facet, const Facets& facets, double rounding_m) {
  std::vector<Line> lines;
  const auto add = [&](const Line& line) {
    // Omits the lines of neighbours, which meet the facet at a corner only.
    Screen screen(facet);
    screen.add(std::span(&line, 1), facet.normal, -facet.normal, rounding_m);
    if (!screen.traces().empty()) lines.push_back(line);
  };
  std::map<EdgeKey, int> in_plane;  // sides on which the surface continues: 1 above, 2 below
  for (uint32_t instance = 0; instance < facets.instances(); ++instance) {
    const Ball& all = facets.ball_of(instance);
    if ((all.centre_m - facet.ball.centre_m).norm() > all.radius_m + facet.ball.radius_m) continue;
    for (const Facet& other : facets.of(instance)) {
      const double apart_m = (other.ball.centre_m - facet.ball.centre_m).norm();
      if (&other == &facet || apart_m > other.ball.radius_m + facet.ball.radius_m) continue;
      std::array<double, 3> height_m;
      for (size_t i = 0; i < 3; ++i) {
        height_m[i] = facet.normal.dot(other.corner_m[i] - facet.corner_m[0]);
      }
      const auto [low, high] = std::minmax_element(height_m.begin(), height_m.end());
      if (*low > rounding_m || *high < -rounding_m) continue;
      std::vector<Vec3> ends_m;
      for (size_t i = 0; i < 3; ++i) {
        if (std::abs(height_m[i]) <= rounding_m) ends_m.push_back(other.corner_m[i]);
      }
      if (ends_m.size() == 3) continue;
      // An edge in the facet's plane is a cut if the surface continues below it.
      const bool on_edge = ends_m.size() == 2;
      for (size_t i = 0; i < 3 && ends_m.size() < 2; ++i) {
        const size_t j = (i + 1) % 3;
        const bool apart = std::min(std::abs(height_m[i]), std::abs(height_m[j])) > rounding_m;
        if (!apart || (height_m[i] < 0.0) == (height_m[j] < 0.0)) continue;
        const double part = height_m[i] / (height_m[i] - height_m[j]);
        ends_m.emplace_back(other.corner_m[i] + part * (other.corner_m[j] - other.corner_m[i]));
      }
      if (ends_m.size() != 2) continue;
      if (on_edge) {
        const int side = *high > rounding_m ? 1 : 2;
        int& sides = in_plane[key_of(instance, ends_m[0], ends_m[1])];
        if ((sides | side) != 3 || sides == 3) {
          sides |= side;
          continue;
        }
        sides = 3;
      }
      add({ends_m[0], ends_m[1]});
    }
  }
  return lines;
}

}  // namespace

Outlines::Outlines(const Facets& facets) {
  std::map<EdgeKey, size_t> known;
  for (uint32_t instance = 0; instance < facets.instances(); ++instance) {
    for (const Facet& facet : facets.of(instance)) {
      for (size_t i = 0; i < 3; ++i) {
        const Vec3 &a = facet.corner_m[i], &b = facet.corner_m[(i + 1) % 3];
        const auto [place, is_new] = known.emplace(key_of(instance, a, b), edges_.size());
        if (is_new) {
          edges_.push_back({{a, b}, {facet.normal, Vec3::Zero()}, 1});
          continue;
        }
        Edge& edge = edges_[place->second];
        // Neighbours with the same orientation traverse their common edge in opposite directions.
        if (edge.facets == 1) edge.normal[1] = edge.line.from_m == a ? -facet.normal : facet.normal;
        ++edge.facets;
      }
    }
  }
}

std::vector<Line> Outlines::in_light(const Vec3& travel, bool creases) const {
  constexpr double smooth = 0.95;  // cosine between neighbours, 18 deg
  std::vector<Line> lines;
  for (const Edge& edge : edges_) {
    const bool is_crease = creases && edge.normal[0].dot(edge.normal[1]) < smooth;
    if (is_crease || edge.facets != 2 ||
        edge.normal[0].dot(travel) * edge.normal[1].dot(travel) <= 0.0) {
      lines.push_back(edge.line);
    }
  }
  return lines;
}

BodyShape::BodyShape(const TraceableScene& scene) : facets(scene.scene()), outlines(facets) {
  const double rounding_m = plane_rounding * scene_diameter_m(scene);
  for (const Facet& facet : facets.all()) cuts.push_back(cuts_through(facet, facets, rounding_m));
}

LineGrid::LineGrid(const TraceableScene& scene, const Outlines& outlines, const Vec3& travel)
    : lines_(outlines.in_light(travel)),
      centre_m_(scene_centre_m(scene)),
      across_(travel.unitOrthogonal()),
      aside_(travel.cross(across_)),
      low_m_(-0.5 * scene_diameter_m(scene)),
      per_m_(width / scene_diameter_m(scene)),
      cells_(width * width),
      seen_(lines_.size(), 0) {
  for (uint32_t i = 0; i < lines_.size(); ++i) add(i);
}

int LineGrid::column(double x_m) const {
  return std::clamp(static_cast<int>((x_m - low_m_) * per_m_), 0, width - 1);
}

// Adds the line to its cells: in each column, to the rows that it crosses there.
void LineGrid::add(uint32_t index) {
  const Line& line = lines_[index];
  Vec2 from = seen(line.from_m), to = seen(line.to_m);
  if (from.x() > to.x()) std::swap(from, to);
  const int first = column(from.x()), last = column(to.x());
  for (int c = first; c <= last; ++c) {
    const auto height_at = [&](double x) {
      const double run = to.x() - from.x();
      const double part = run > 0.0 ? std::clamp((x - from.x()) / run, 0.0, 1.0) : 0.0;
      return from.y() + part * (to.y() - from.y());
    };
    double one = from.y(), other = to.y();
    if (first != last) {
      one = height_at(low_m_ + c / per_m_);
      other = height_at(low_m_ + (c + 1) / per_m_);
    }
    // Margin for rounding.
    const double margin = 1e-9 / per_m_;
    const int bottom = column(std::min(one, other) - margin);
    const int top = column(std::max(one, other) + margin);
    for (int r = bottom; r <= top; ++r) cells_[cell(c, r)].push_back(index);
  }
}

void LineGrid::over(const TriangleCorners& corners_m, std::vector<Line>& found) {
  found.clear();
  ++question_;
  Eigen::AlignedBox2d box;
  for (const Vec3& corner : corners_m) box.extend(seen(corner));
  const double margin = 1e-9 / per_m_;
  for (int c = column(box.min().x() - margin); c <= column(box.max().x() + margin); ++c) {
    for (int r = column(box.min().y() - margin); r <= column(box.max().y() + margin); ++r) {
      for (const uint32_t index : cells_[cell(c, r)]) {
        if (seen_[index] == question_) continue;
        seen_[index] = question_;
        found.push_back(lines_[index]);
      }
    }
  }
}

}  // namespace photorque
