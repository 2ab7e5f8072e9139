#include "scenes/gltf/mesh_closure.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/numerics/connected.h"
#include "core/text/format.h"

namespace photorque {
namespace {

struct Edge {
  uint32_t low, high;
  bool is_forward;  // whether its triangle goes from `low` to `high`

  auto ends() const { return std::pair(low, high); }
};

std::vector<Edge> edges_of(const Mesh& mesh, const std::vector<uint32_t>& first) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = first[triangle[k]], b = first[triangle[(k + 1) % 3]];
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::ranges::sort(edges, {}, &Edge::ends);
  return edges;
}

// Whether `point` lies on the inside of the edge from a to b, to a millionth of its length.
bool lies_on(const Vec3& point, const Vec3& a, const Vec3& b) {
  constexpr double tolerance = 1e-6;
  const Vec3 along = b - a, to = point - a;
  const double t = to.dot(along) / along.squaredNorm();
  return t > tolerance && t < 1.0 - tolerance &&
         (to - t * along).norm() <= tolerance * along.norm();
}

// T-junctions have open edges on both sides, so only the ends of open edges are tested. They are
// sorted along x, and each edge tests only those in its interval.
size_t count_t_junctions(const Mesh& mesh, const std::vector<Edge>& open) {
  std::vector<uint32_t> ends;
  for (const Edge& edge : open) ends.insert(ends.end(), {edge.low, edge.high});
  const auto x_of = [&](uint32_t vertex) { return mesh.vertices_m[vertex].x(); };
  std::sort(ends.begin(), ends.end(),
            [&](uint32_t a, uint32_t b) { return x_of(a) != x_of(b) ? x_of(a) < x_of(b) : a < b; });
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  size_t count = 0;
  for (const Edge& edge : open) {
    const Vec3 &a = mesh.vertices_m[edge.low], &b = mesh.vertices_m[edge.high];
    const double slack = 1e-6 * (b - a).norm();
    const double low = std::min(a.x(), b.x()) - slack, high = std::max(a.x(), b.x()) + slack;
    auto end = std::lower_bound(ends.begin(), ends.end(), low,
                                [&](uint32_t vertex, double x) { return x_of(vertex) < x; });
    for (; end != ends.end() && x_of(*end) <= high; ++end) {
      if (*end == edge.low || *end == edge.high || !lies_on(mesh.vertices_m[*end], a, b)) continue;
      ++count;
      break;
    }
  }
  return count;
}

void add(const Mesh& mesh, MeshClosure& closure) {
  constexpr size_t max_open_edges = 100'000;
  const std::vector<Edge> edges = edges_of(mesh, welded(mesh.vertices_m));
  std::vector<Edge> open;
  size_t distinct = 0;
  bool has_turned_face = false;
  for (size_t i = 0; i < edges.size();) {
    size_t end = i;
    while (end < edges.size() && edges[end].ends() == edges[i].ends()) ++end;
    ++distinct;
    if (end - i == 1) open.push_back(edges[i]);
    // Two triangles with one front side go along their common edge in opposite directions.
    if (end - i == 2 && edges[i].is_forward == edges[i + 1].is_forward) has_turned_face = true;
    i = end;
  }
  ++closure.meshes;
  const bool closed = open.empty() && distinct > 0, few_open = open.size() * open.size() < distinct;
  if (open.empty()) ++closure.closed;
  if (!open.empty() && few_open) ++closure.almost_closed;
  if ((closed || few_open) && has_turned_face) ++closure.with_turned_faces;
  closure.encloses.push_back((closed || few_open) && !has_turned_face ? 1 : 0);
  closure.open_edges += open.size();
  if (open.size() <= max_open_edges) closure.t_junctions += count_t_junctions(mesh, open);
}

// Whether the mesh encloses a volume. A sheet drawn from both sides has no open edge, but no
// volume.
bool has_volume(const Mesh& mesh) {
  constexpr double rounding = 1e-9;
  double six_volumes = 0.0, two_areas = 0.0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 to = mesh.vertices_m[i] - mesh.vertices_m[mesh.triangles[0][0]];
    const Vec3 cross =
        (mesh.vertices_m[j] - mesh.vertices_m[i]).cross(mesh.vertices_m[k] - mesh.vertices_m[i]);
    six_volumes += to.dot(cross);
    two_areas += cross.norm();
  }
  return std::abs(six_volumes) > rounding * std::pow(two_areas, 1.5);
}

}  // namespace

MeshClosure closure_of(const Scene& scene) {
  MeshClosure closure;
  for (const Mesh& mesh : scene.meshes) {
    add(mesh, closure);
    if (!has_volume(mesh)) closure.encloses.back() = 0;
  }
  return closure;
}

std::string describe_closure(const MeshClosure& closure) {
  std::string text;
  if (closure.t_junctions > 0 || closure.almost_closed > 0) {
    text = printed(
        "%zu of %zu meshes are closed; the others have %zu open edges, %zu of them with a vertex "
        "on them (T-junctions)",
        closure.closed, closure.meshes, closure.open_edges, closure.t_junctions);
    if (closure.almost_closed > 0) {
      text += printed("; %zu mesh(es) are closed but for a few edges", closure.almost_closed);
    }
    text += ": light may leak there";
  }
  if (closure.with_turned_faces > 0) {
    text += printed("%s%zu closed mesh(es) have neighbouring faces with opposite front sides: %s",
                    text.empty() ? "" : "; ", closure.with_turned_faces,
                    "light inside of them is not reported");
  }
  return text;
}

}  // namespace photorque
