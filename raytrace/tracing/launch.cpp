#include "raytrace/tracing/launch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include "core/numerics/transpose.h"

namespace photorque {

RayPlacement::RayPlacement(const RigidTransform& body_from_emitter,
                           const TraceableScene::Data& scene) {
  const double centre_z_m = body_from_emitter.inverse().point(scene.centre_m).z();
  const double start_z_m = std::max(0.0, centre_z_m - 1.001 * scene.radius_m);
  starts_late_ = start_z_m > 0.0;
  start_z_m_ = static_cast<float>(start_z_m);
  landing_z_m_ = static_cast<float>(centre_z_m);
  rotation_ = body_from_emitter.rotation.toRotationMatrix().cast<float>();
  const Vec3 start_m = body_from_emitter.point(Vec3(0.0, 0.0, start_z_m));
  offset_m_ = (start_m - scene.centre_m).cast<float>();
}

// Input and output do not overlap; __restrict lets the compiler vectorise.
void RayPlacement::place(const RayBlock& __restrict rays, RayColumns& __restrict placed,
                         Landing& __restrict landing) const {
  constexpr float min_z = 1e-6f;  // of the directions of rays that may reach the plane
  const float start_m = start_z_m_, landing_m = landing_z_m_;
  const float late = starts_late_ ? 1.0f : 0.0f;
  const float ahead = landing_m > 0.0f ? 1.0f : 0.0f;
  const Eigen::Matrix3f r = rotation_;
  const Eigen::Vector3f offset_m = offset_m_;
  for (int i = 0; i < ray_block; ++i) {
    const float fx = rays.direction[0][i], fy = rays.direction[1][i], fz = rays.direction[2][i];
    const float ex = rays.origin_m[0][i], ey = rays.origin_m[1][i], ez = rays.origin_m[2][i];
    const float per_z = 1.0f / (fz > min_z ? fz : min_z);
    const float gap_m = late * (start_m > ez ? start_m - ez : 0.0f);
    const float step = gap_m * per_z;
    const float sx = ex + step * fx, sy = ey + step * fy;
    // For rays that reach the plane, set z exactly, without rounding.
    const float on_plane = (fz > min_z ? 1.0f : 0.0f) * (gap_m > 0.0f ? 1.0f : 0.0f);
    const float sz = (1.0f - on_plane) * (step * fz + (ez - start_m));
    for (int k = 0; k < 3; ++k) {
      placed[k][i] = r(k, 0) * sx + r(k, 1) * sy + r(k, 2) * sz + offset_m[k];
      placed[3 + k][i] = r(k, 0) * fx + r(k, 1) * fy + r(k, 2) * fz;
    }
    const float reach = ahead * (landing_m - ez) * per_z + (1.0f - ahead);
    landing.x[i] = ahead * ex + reach * fx;
    landing.y[i] = ahead * ey + reach * fy;
  }
}

namespace {

// Binary logarithm of the number of rays per batch. A batch is large enough that sorting brings
// packets of close neighbours together. It is small enough to stay in the cache and to be numbered
// with 16 bits.
constexpr int log2_batch = 13;

// Bits of a landing cell per side, such that a cell contains about eight rays of a batch: one
// packet.
uint32_t cell_bits(uint32_t batch) {
  return (static_cast<uint32_t>(std::bit_width(batch)) - 3u) / 2u;
}

// Grid of cells on the part of the plane where a batch lands.
struct LandingGrid {
  uint32_t bits;  // per side
  float x_low, y_low, x_scale, y_scale;

  // Derives the grid from some rays of the batch.
  LandingGrid(const LandingRange& range, uint32_t batch, const Landing& some)
      : bits(cell_bits(batch)) {
    const auto [x_least, x_most] = std::minmax_element(some.x.begin(), some.x.end());
    const auto [y_least, y_most] = std::minmax_element(some.y.begin(), some.y.end());
    x_low = std::max(*x_least, range.min().x());
    y_low = std::max(*y_least, range.min().y());
    const float side = static_cast<float>(1u << bits);
    x_scale = side / std::max(std::min(*x_most, range.max().x()) - x_low, 1e-30f);
    y_scale = side / std::max(std::min(*y_most, range.max().y()) - y_low, 1e-30f);
  }
};

void make_keys(const LaunchPlan& plan, const LandingGrid& grid, const Landing& at,
               const RayColumns& placed, uint16_t* key) {
  const float last = static_cast<float>(1u << grid.bits) - 1.0f;
  const std::array<uint32_t, 3> step = plan.octant_step;
  for (int i = 0; i < ray_block; ++i) {
    const float fx = std::min(std::max((at.x[i] - grid.x_low) * grid.x_scale, 0.0f), last);
    const float fy = std::min(std::max((at.y[i] - grid.y_low) * grid.y_scale, 0.0f), last);
    const uint32_t cell = with_gaps(static_cast<uint32_t>(static_cast<int32_t>(fx))) |
                          (with_gaps(static_cast<uint32_t>(static_cast<int32_t>(fy))) << 1);
    const uint32_t octant = (std::bit_cast<uint32_t>(placed[3][i]) >> 31) * step[0] +
                            (std::bit_cast<uint32_t>(placed[4][i]) >> 31) * step[1] +
                            (std::bit_cast<uint32_t>(placed[5][i]) >> 31) * step[2];
    key[i] = static_cast<uint16_t>((octant << (2 * grid.bits)) | cell);
  }
}

// Converts columns to records.
void store(const RayColumns& placed, Ray* out) {
  for (int begin = 0; begin < ray_block; begin += 8) {
    std::array<const float*, 8> rows;
    for (size_t c = 0; c < 8; ++c) rows[c] = &placed[c][begin];
    transpose_8x8(rows, &out[begin].origin_m[0], 8);
  }
}

void counting_sort(uint32_t key_count, LaunchBuffer& buffer) {
  const auto count = static_cast<uint32_t>(buffer.key.size());
  buffer.start.assign(key_count + 1, 0);
  for (uint32_t i = 0; i < count; ++i) ++buffer.start[buffer.key[i] + 1u];
  for (uint32_t k = 0; k < key_count; ++k) {
    buffer.start[k + 1] = static_cast<uint16_t>(buffer.start[k + 1] + buffer.start[k]);
  }
  for (uint32_t i = 0; i < count; ++i) {
    buffer.order[buffer.start[buffer.key[i]]++] = static_cast<uint16_t>(i);
  }
}

// Statistics of a sample of a beam's rays.
struct BeamSample {
  LandingRange range;
  std::array<uint32_t, 3> negative{};     // components of directions in the body frame
  double aperture2 = 0.0, spread2 = 0.0;  // Σ x² + y² of origins, and of directions
  static constexpr uint32_t rays = 4 * sobol_block;
};

void emit(const Emitter& emitter, const std::optional<Targets>& targets, SampleBlock& samples,
          RayBlock& rays) {
  if (targets) {
    targets->emit(samples, rays);
  } else {
    emitter.emit(samples, rays);
  }
}

BeamSample sample_beam(const Emitter& emitter, const std::optional<Targets>& targets,
                       const RayPlacement& placement) {
  BeamSample sample;
  SampleBlock samples;
  RayBlock rays;
  Landing landing;
  RayColumns placed;
  for (uint32_t first = 0; first < BeamSample::rays; first += sobol_block) {
    sobol_points({}, first, samples.columns());
    emit(emitter, targets, samples, rays);
    placement.place(rays, placed, landing);
    for (size_t i = 0; i < ray_block; ++i) {
      sample.range.extend(Eigen::Vector2f(landing.x[i], landing.y[i]));
      for (size_t k = 0; k < 2; ++k) {
        sample.aperture2 += rays.origin_m[k][i] * rays.origin_m[k][i];
        sample.spread2 += rays.direction[k][i] * rays.direction[k][i];
      }
      for (size_t k = 0; k < 3; ++k) sample.negative[k] += std::signbit(placed[3 + k][i]) ? 1 : 0;
    }
  }
  return sample;
}

// Number of leading bits that the rays of a batch have in common, per dimension, so that they land
// close together. The aperture or the directions are halved in each step, whichever spreads the
// landing points more; in each the azimuth is halved first.
std::array<int, sobol_dimensions> shared_bits(int bits, double aperture_m, double spread_m) {
  int of_aperture = 0, of_direction = 0;
  while (of_aperture + of_direction < bits) {
    const bool aperture =
        aperture_m * std::exp2(-0.5 * of_aperture) >= spread_m * std::exp2(-0.5 * of_direction);
    ++(aperture ? of_aperture : of_direction);
  }
  const auto radial = [](int both) { return std::max(both - 1, 0) / 2; };
  return {radial(of_aperture), of_aperture - radial(of_aperture), radial(of_direction),
          of_direction - radial(of_direction)};
}

}  // namespace

LaunchPlan plan_launch(const Emitter& emitter, const RigidTransform& body_from_emitter,
                       const TraceableScene::Data& scene, int log2_rays,
                       std::optional<Targets> targets) {
  const RigidTransform& body_from_rays = targets ? targets->body_from_rays() : body_from_emitter;
  const Vec3 centre = body_from_rays.inverse().point(scene.centre_m);
  const RayPlacement placement(body_from_rays, scene);
  const BeamSample sample = sample_beam(emitter, targets, placement);
  const auto bits = shared_bits(std::max(log2_rays - log2_batch, 0), std::sqrt(sample.aperture2),
                                std::sqrt(sample.spread2) * std::max(centre.z(), 0.0));
  LaunchPlan plan{SobolCells(log2_rays, bits), placement, std::move(targets), sample.range};
  if (centre.z() > 0.0) {  // rays that miss the scene need no order
    const Eigen::Vector2f middle = centre.head<2>().cast<float>();
    const auto radius = Eigen::Vector2f::Constant(static_cast<float>(scene.radius_m));
    plan.range.clamp({middle - radius, middle + radius});
  }
  for (size_t k = 0; k < 3; ++k) {
    if (sample.negative[k] == 0 || sample.negative[k] == BeamSample::rays) continue;
    plan.octant_step[k] = plan.octants;
    plan.octants *= 2;
  }
  return plan;
}

void launch(const Emitter& emitter, const LaunchPlan& plan, const SobolStream& stream,
            uint32_t cell, LaunchBuffer& buffer) {
  const uint32_t count = plan.cells.points_per_cell();
  buffer.rays.resize(count);
  buffer.order.resize(count);
  buffer.key.resize(count);
  SampleBlock samples;
  std::array<uint32_t, ray_block> index;
  RayBlock rays;
  Landing landing;
  RayColumns placed;
  placed[7].fill(0.0f);
  std::optional<LandingGrid> grid;
  for (uint32_t i = 0; i < count; i += ray_block) {
    plan.cells.points(stream, cell, i, samples.columns(), index.data());
    emit(emitter, plan.targets, samples, rays);
    plan.placement.place(rays, placed, landing);
    if (!grid) grid.emplace(plan.range, count, landing);
    make_keys(plan, *grid, landing, placed, &buffer.key[i]);
    for (int k = 0; k < ray_block; ++k) placed[6][k] = std::bit_cast<float>(index[k]);
    store(placed, &buffer.rays[i]);
  }
  counting_sort(plan.octants << (2 * grid->bits), buffer);
}

}  // namespace photorque
