#include "receivers/gather/gather.h"

#include <algorithm>

#include "core/constants.h"
#include "core/errors.h"
#include "receivers/gather/lamp.h"
#include "receivers/gather/quadrature.h"
#include "receivers/gather/shaded_sampler.h"

namespace photorque {
namespace {

constexpr size_t torque_axes = 3;

// Adds a torque to the entries of a bin.
void add_to_bin(const Vec3& torque_N_m, size_t bin, std::span<double> entries) {
  Eigen::Map<Vec3>(entries.data() + bin * torque_axes) += torque_N_m;
}

// Quantity of ShadedSampler: the torque of light about a point.
class Torque {
 public:
  using Value = Vec3;

  Torque(const GatherPlane& plane, const Vec3& about_m) : plane_(plane), about_m_(about_m) {}

  // Torque per area at a point of the plane [N/m].
  Vec3 density_N_m(const Vec3& at_m, const GatherLamp& lamp, uint32_t instance) const {
    return torque(at_m, lamp.arriving(at_m), lamp, instance);
  }

  // Torque of a lit ray [N m].
  Vec3 of(const CandidateRay& ray, const GatherLamp& lamp) const {
    const Vec3 at_m = lamp.body_from_emitter().point(ray.at_m);
    const Vec3 way = at_m - lamp.body_from_emitter().point(ray.from_m);
    return torque(at_m, {ray.power_W, ray.power_W * way.normalized()}, lamp, ray.instance);
  }
  void add(const Vec3& torque_N_m, const GatherLamp&, size_t bin, uint32_t,
           std::span<double> entries) const {
    add_to_bin(torque_N_m, bin, entries);
  }

  const Vec3& about_m() const { return about_m_; }

 private:
  Vec3 torque(const Vec3& at_m, const ArrivingLight& light, const GatherLamp& lamp,
              uint32_t instance) const {
    const FirstContact contact(plane_.surface(instance), true, lamp.fraction(),
                               plane_.bands().count());
    const Vec3 kept = contact.of_flow(light, plane_.normal());
    return (at_m - about_m_).cross(kept) / speed_of_light_m_s;
  }

  const GatherPlane& plane_;
  Vec3 about_m_;
};

// Adds the torque on bins that nothing can shade.
class OpenTorque {
 public:
  OpenTorque(const GatherPlane& plane, const Torque& torque)
      : plane_(plane), torque_(torque), tiles_(plane.grid()) {
    for (const int column : {0, plane.grid().width}) {
      for (const int row : {0, plane.grid().height}) {
        arm_m_ = std::max(arm_m_, (plane.point_m(column, row) - torque.about_m()).norm());
      }
    }
  }

  // Adds torques and the bounds of their errors to the entries. Returns the number of bins with a
  // surface.
  size_t add(const BinTile& tile, const Ball& ball, const GatherLamp& lamp,
             std::span<double> torque_N_m, std::span<double> bound_N_m) const {
    const double tolerance_N_m =
        tolerance * arm_m_ * lamp.typical_W_m2(ball) / speed_of_light_m_s;  // per area
    const double turns = 2.0 * ball.radius_m / lamp.scale_m(ball);
    if (const auto instance = only_instance(tile); instance && lamp.smooth_over(ball)) {
      for (const size_t nodes : tiles_.attempts(tile, turns)) {
        double error = 0.0;
        const std::array<Eigen::MatrixXd, torque_axes> means =
            means_of(tile, nodes, lamp, *instance, error);
        if (error > tolerance_N_m) continue;
        for (int row = 0; row < tile.rows; ++row) {
          for (int column = 0; column < tile.columns; ++column) {
            const size_t bin = plane_.bin_at(tile.column + column, tile.row + row);
            const Vec3 mean(means[0](column, row), means[1](column, row), means[2](column, row));
            const double area_m2 = plane_.patches().of(bin)[0].area_m2;
            add_to_bin(area_m2 * mean, bin, torque_N_m);
            add_to_bin(Vec3::Constant(area_m2 * error), bin, bound_N_m);
          }
        }
        return static_cast<size_t>(tile.count());
      }
    }
    if (tile.count() == 1) return add_patches(tile, lamp, tolerance_N_m, torque_N_m, bound_N_m);
    size_t open = 0;
    for (const BinTile& half : tile.halves()) {
      const Ball half_ball = plane_.ball_of(half);
      if (!lamp.misses(half_ball)) open += add(half, half_ball, lamp, torque_N_m, bound_N_m);
    }
    return open;
  }

 private:
  static constexpr double tolerance = 1e-6;

  // Mean torques per area over the bins of a tile; `error` is common to all of them.
  std::array<Eigen::MatrixXd, torque_axes> means_of(const BinTile& tile, size_t nodes,
                                                    const GatherLamp& lamp, uint32_t instance,
                                                    double& error) const {
    const auto points = static_cast<Eigen::Index>(nodes);
    const std::vector<double>& fraction = tiles_.fractions(nodes);
    std::array<Eigen::MatrixXd, torque_axes> values;
    for (auto& axis : values) axis.resize(points, points);
    for (Eigen::Index j = 0; j < points; ++j) {
      for (Eigen::Index i = 0; i < points; ++i) {
        const Vec3 at_m =
            plane_.point_m(tile.column + tile.columns * fraction[static_cast<size_t>(i)],
                           tile.row + tile.rows * fraction[static_cast<size_t>(j)]);
        const Vec3 density = torque_.density_N_m(at_m, lamp, instance);
        for (size_t k = 0; k < torque_axes; ++k) {
          values[k](i, j) = density[static_cast<Eigen::Index>(k)];
        }
      }
    }
    for (auto& axis : values) axis = tiles_.means_of(tile, axis, error);
    return values;
  }

  // The instance of a tile if all of its bins are completely on one instance; else empty.
  std::optional<uint32_t> only_instance(const BinTile& tile) const {
    std::optional<uint32_t> instance;
    for (int row = tile.row; row < tile.row + tile.rows; ++row) {
      for (int column = tile.column; column < tile.column + tile.columns; ++column) {
        const size_t bin = plane_.bin_at(column, row);
        if (!plane_.whole(bin)) return std::nullopt;
        const uint32_t here = plane_.patches().of(bin)[0].instance;
        if (instance && *instance != here) return std::nullopt;
        instance = here;
      }
    }
    return instance;
  }

  // Integrates over each patch by nested integrals; the inner one is divided at the kinks of the
  // light.
  size_t add_patches(const BinTile& tile, const GatherLamp& lamp, double tolerance_N_m,
                     std::span<double> torque_N_m, std::span<double> bound_N_m) const {
    constexpr int depth = 12;
    const size_t bin = plane_.bin_at(tile.column, tile.row);
    const auto patches = plane_.patches().of(bin);
    for (const SurfacePatch& patch : patches) {
      double inner_error = 0.0;
      const auto along = [&](double t) -> Eigen::Array3d {
        const double length = patch.triangle ? 1.0 - t : 1.0;
        const Vec3 from = patch.origin_m + t * patch.edge2_m, way = length * patch.edge1_m;
        const auto density = [&](double s) -> Eigen::Array3d {
          return torque_.density_N_m(from + s * way, lamp, patch.instance).array();
        };
        Eigen::Array3d sum = Eigen::Array3d::Zero();
        double left = 0.0;
        for (const double right : lamp.kinks_along(from, from + way)) {
          const auto part = integrate_adaptively(density, left, right, 0.2 * tolerance_N_m, depth);
          sum += part.value;
          inner_error = std::max(inner_error, part.error);
          left = right;
        }
        return length * sum;
      };
      Integral<Eigen::Array3d> mean{Eigen::Array3d::Zero(), 0.0};
      double low = 0.0;
      for (const double high : lamp.kinks_across(patch)) {
        const auto part = integrate_adaptively(along, low, high, 0.2 * tolerance_N_m, depth);
        mean = {mean.value + part.value, mean.error + part.error};
        low = high;
      }
      const double area_m2 = patch.area_m2 * (patch.triangle ? 2.0 : 1.0);
      add_to_bin(area_m2 * mean.value.matrix(), bin, torque_N_m);
      add_to_bin(Vec3::Constant(area_m2 * (mean.error + 2.0 * inner_error)), bin, bound_N_m);
    }
    return patches.empty() ? 0 : 1;
  }

  const GatherPlane& plane_;
  const Torque& torque_;
  ChebyshevTiles tiles_;
  double arm_m_ = 0.0;  // maximum distance from the reference point
};

// Adds the torque of light on one side to `total`.
void add_side(const TraceableScene& scene, const RigidTransform& lab_from_body,
              std::span<const Beam> beams, const TorqueMapReceiver& map, Side side,
              const GatherOptions& options, Gathered& total) {
  const Gathering gathering(scene, lab_from_body, beams, map.grid(), side, options.threads, false);
  const Torque torque(gathering.plane(), map.about_body_m());
  const OpenTorque open_torque(gathering.plane(), torque);
  std::vector<double> open(map.direct_entries(), 0.0);
  std::vector<size_t> counted(gathering.sights().size(), 0);
  parallel_for(gathering.sights().size(), options.threads, [&](size_t t) {
    for (const OpenTile& tile : gathering.sights()[t].open) {
      counted[t] += open_torque.add(tile.tile, tile.ball, gathering.lamp(tile.lamp), open,
                                    total.direct.bound);
    }
  });
  const std::vector<double> sums =
      sample_shaded(gathering, torque, open, options, options.points, total.shadow_rays);
  for (size_t i = 0; i < sums.size(); ++i) total.direct.sums[i] += sums[i];
  total.open_pairs += std::accumulate(counted.begin(), counted.end(), size_t{0});
  total.shaded_pairs += gathering.shaded_pairs();
}

}  // namespace

bool can_gather_torque(const Scene& scene, const SurfaceGrid& grid, std::span<const Beam> beams) {
  const auto plain = [&](const Instance& instance, bool front) {
    return scene.surface(instance, front).bsdf == nullptr;
  };
  return is_gatherable(scene, grid, beams) &&
         std::all_of(grid.instances.begin(), grid.instances.end(), [&](uint32_t instance) {
           const Instance& of = scene.instances[instance];
           return plain(of, true) && plain(of, false);
         });
}

Gathered gather_torque(const TraceableScene& scene, const RigidTransform& lab_from_body,
                       std::span<const Beam> beams, const TorqueMapReceiver& map,
                       const GatherOptions& options) {
  if (!can_gather_torque(scene.scene(), map.grid(), beams)) {
    throw InputError({"gather"}, map.name(), "a surface or a source that needs rays",
                     "a flat, plain surface, and sources with uniform apertures");
  }
  Gathered total;
  const size_t entries = map.direct_entries();
  total.direct = {entries, options.replicates,
                  std::vector<double>(entries * static_cast<size_t>(options.replicates), 0.0),
                  std::vector<double>(entries, 0.0)};
  const Side seen = map.grid().side;
  for (const Side side : {Side::front, Side::back}) {
    if (seen == Side::both || seen == side) {
      add_side(scene, lab_from_body, beams, map, side, options, total);
    }
  }
  return total;
}

}  // namespace photorque
