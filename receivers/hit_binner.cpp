#include "receivers/hit_binner.h"

namespace photorque {
namespace {

constexpr uint8_t no_side = 0;

uint8_t side_bits(Side side) {
  switch (side) {
    case Side::front:
      return 0b10;
    case Side::back:
      return 0b01;
    case Side::both:
      return 0b11;
  }
  return no_side;
}

// Cell of a coordinate; outside the grid the nearest cell. NaN gives cell 0.
uint32_t cell_of(double coordinate, double last) {
  const double inside = coordinate > 0.0 ? coordinate : 0.0;
  return static_cast<uint32_t>(static_cast<int32_t>(inside < last ? inside : last));
}

// Appends a run, or extends the previous one if they touch.
void add_run(BinnedHits& out, BinnedHits::Run run) {
  if (out.runs > 0 && out.run[static_cast<size_t>(out.runs) - 1].end == run.begin) {
    out.run[static_cast<size_t>(out.runs) - 1].end = run.end;
  } else {
    out.run[static_cast<size_t>(out.runs++)] = run;
  }
}

}  // namespace

HitBinner::HitBinner(const Scene& scene, const SurfaceGrid& grid)
    : over_(grid.over),
      width_(static_cast<uint32_t>(grid.width)),
      side_bits_(scene.instances.size(), no_side),
      first_face_(scene.instances.size(), 0) {
  size_t triangles = 0;
  for (const uint32_t instance : grid.instances) {
    side_bits_[instance] = side_bits(grid.side);
    first_face_[instance] = static_cast<uint32_t>(triangles);
    triangles += scene.meshes[scene.instances[instance].mesh].triangles.size();
  }
  const auto faces = faces_of(scene, grid.instances, grid.facing_body);
  if (grid.facing_body) {
    turned_towards_.assign(triangles, 0);
    for (const SurfaceFace& face : faces) {
      turned_towards_[first_face_[face.instance] + face.triangle] = 1;
    }
  }
  column_.last = grid.width - 1.0;
  row_.last = grid.height - 1.0;
  if (over_ == SurfaceGrid::Over::plane) {
    set_plane(grid);
    return;
  }
  corner_cells_.resize(triangles);
  for (const SurfaceFace& face : faces) {
    auto& corners = corner_cells_[first_face_[face.instance] + face.triangle];
    corners = texture_corners(scene, face);
    for (Vec2& corner : corners) corner = corner.cwiseProduct(Vec2(grid.width, grid.height));
  }
}

void HitBinner::set_plane(const SurfaceGrid& grid) {
  const double u_scale = grid.width / (grid.u_high - grid.u_low);
  const double v_scale = grid.height / (grid.v_high - grid.v_low);
  column_.slope = u_scale * grid.u_axis_body;
  row_.slope = v_scale * grid.v_axis_body;
  column_.offset = -u_scale * grid.u_low;
  row_.offset = -v_scale * grid.v_low;
}

// Neighbouring hits usually share instance and side, which are looked up once for a run of hits.
void HitBinner::collect(const Hits& hits, BinnedHits& out) const {
  const auto count = static_cast<uint32_t>(hits.count);
  out.runs = 0;
  // Often all hits do. This loop tests it and is vectorised.
  uint32_t differences = 0;
  for (uint32_t i = 0; i < count; ++i) {
    differences |= (hits.instance[i] ^ hits.instance[0]) |
                   static_cast<uint32_t>(hits.front[i] ^ hits.front[0]);
  }
  for (uint32_t begin = 0, end = 0; begin < count; begin = end) {
    const uint32_t instance = hits.instance[begin];
    const uint8_t front = hits.front[begin];
    if (differences == 0) end = count;
    while (end < count && hits.instance[end] == instance && hits.front[end] == front) ++end;
    if (((side_bits_[instance] >> front) & 1) == 0) continue;
    if (turned_towards_.empty()) {
      add_run(out, {begin, end});
    } else {
      collect_turned(hits, {begin, end}, out);
    }
  }
}

// Adds the hits of a run on one instance whose triangles face the requested direction.
void HitBinner::collect_turned(const Hits& hits, BinnedHits::Run all, BinnedHits& out) const {
  const uint8_t* turned = turned_towards_.data() + first_face_[hits.instance[all.begin]];
  for (uint32_t begin = all.begin, end = 0; begin < all.end; begin = end + 1) {
    end = begin;
    while (end < all.end && turned[hits.triangle[end]] != 0) ++end;
    if (end > begin) add_run(out, {begin, end});
  }
}

// Bins all hits without branches, whether they count or not, so that the compiler can vectorise.
void HitBinner::bin_plane(const Hits& hits, BinnedHits& out) const {
  const CellCoordinate c = column_, r = row_;
  const uint32_t width = width_;
  const auto count = static_cast<size_t>(hits.count);
  for (size_t i = 0; i < count; ++i) {
    const double x = hits.position_m[0][i], y = hits.position_m[1][i], z = hits.position_m[2][i];
    const double s = c.slope[0] * x + c.slope[1] * y + c.slope[2] * z + c.offset;
    const double t = r.slope[0] * x + r.slope[1] * y + r.slope[2] * z + r.offset;
    out.bin[i] = cell_of(t, r.last) * width + cell_of(s, c.last);
  }
}

void HitBinner::bin_texture(const Hits& hits, BinnedHits& out) const {
  for (size_t r = 0; r < static_cast<size_t>(out.runs); ++r) {
    for (size_t i = out.run[r].begin; i < out.run[r].end; ++i) {
      const auto& [a, b, c] = corner_cells_[first_face_[hits.instance[i]] + hits.triangle[i]];
      const double weight_b = hits.barycentric[0][i], weight_c = hits.barycentric[1][i];
      const Vec2 cell = a + weight_b * (b - a) + weight_c * (c - a);
      out.bin[i] = cell_of(cell.y(), row_.last) * width_ + cell_of(cell.x(), column_.last);
    }
  }
}

void HitBinner::bin(const Hits& hits, BinnedHits& out) const {
  collect(hits, out);
  if (out.runs == 0) return;
  if (over_ == SurfaceGrid::Over::plane) {
    bin_plane(hits, out);
  } else {
    bin_texture(hits, out);
  }
}

}  // namespace photorque
