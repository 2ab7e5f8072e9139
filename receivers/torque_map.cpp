#include "receivers/torque_map.h"

#include "core/constants.h"
#include "receivers/kind.h"
#include "receivers/surface_grid.h"

namespace photorque {
namespace {

constexpr size_t axes = 3;

Vec3 force_as_published_N(const Hits& hits, size_t hit) {
  double power_W = 0.0;
  for (size_t band = 0; band < static_cast<size_t>(hits.bands); ++band) {
    power_W += hits.incident_W[band][hit];
  }
  const auto along = [&](size_t axis) { return static_cast<double>(hits.direction[axis][hit]); };
  return power_W * hits.cosine[hit] / speed_of_light_m_s * Vec3(along(0), along(1), along(2));
}

}  // namespace

TorqueMapReceiver::TorqueMapReceiver(std::string name, const Scene& scene, SurfaceGrid grid,
                                     const Vec3& about_body_m, Force force)
    : name_(std::move(name)),
      grid_(std::move(grid)),
      about_body_m_(about_body_m),
      force_(force),
      binner_(scene, grid_) {}

size_t TorqueMapReceiver::bins() const {
  return 2 * grid_.bins() * axes;
}

void TorqueMapReceiver::score(const Hits& hits, std::span<double> sums) const {
  const bool as_published = force_ == Force::as_published;
  if (as_published && hits.depth > 0) return;
  BinnedHits binned;
  binner_.bin(hits, binned);
  const Vec3 about_m = about_body_m_;
  const size_t offset = hits.depth == 0 ? 0 : direct_entries();
  for_each_binned(binned, [&](size_t hit, size_t index) {
    const Vec3 f = as_published ? force_as_published_N(hits, hit) : hits.force_at_N(hit);
    Eigen::Map<Vec3>(sums.data() + offset + index * axes) +=
        (hits.position_at_m(hit) - about_m).cross(f);
  });
}

TorqueMap TorqueMapReceiver::torque_map(const BinSums& sums) const {
  TorqueMap map{grid_, about_body_m_, {}, {}};
  for (size_t axis = 0; axis < axes; ++axis) {
    GridEstimates of_axis = estimates_on(
        grid_, sums,
        [axis](std::span<const double> half, size_t bin) { return half[bin * axes + axis]; });
    map.per_bin_N_m[axis] = std::move(of_axis.per_bin);
    map.total_N_m[axis] = of_axis.total;
  }
  return map;
}

Product TorqueMapReceiver::product(const BinSums& sums) const {
  const TorqueMap map = torque_map(sums);
  Product product;
  for (size_t axis = 0; axis < axes; ++axis) {
    const std::string letter(1, "xyz"[axis]);
    product.quantities.push_back(
        {"torque_" + letter + "_" + name_ + "_body_N_m", map.total_N_m[axis]});
    Map picture = grid_map(grid_, map.per_bin_N_m[axis], "torque_" + letter + "_" + name_,
                           "Torque about " + letter + " per bin of " + name_, "N m");
    picture.signed_values = true;
    product.maps.push_back(std::move(picture));
  }
  return product;
}

namespace kinds::torque_map {

constexpr ChoiceKey force_key(
    "force",
    {{"momentum", "momentum in minus momentum out"},
     {"as_published",
      "equation 29 of the paper as printed: all light is absorbed, and the cosine that the "
      "irradiance on a surface already contains is applied again ([paper.md](paper.md))"}},
    0, "law of the force of light on an element");

ReceiverKind kind() {
  return {"torque_map", "Torque of light per bin of a surface",
          [](const Settings& settings, const Scene& scene) -> MadeReceiver {
            const ReceiverTarget target = read_target(settings, scene);
            constexpr TorqueMapReceiver::Force forces[] = {TorqueMapReceiver::Force::momentum,
                                                           TorqueMapReceiver::Force::as_published};
            // Both sides count, so that the total is the torque on the node.
            const auto map = std::make_shared<const TorqueMapReceiver>(
                target.name, scene, read_surface_grid(settings, scene, target, Side::both),
                settings.get(torque_point), forces[settings.get(force_key)]);
            return {.receiver = map, .torque_map = map};
          },
          joined({target_keys(), surface_grid_keys(Side::both), {torque_point, force_key}})};
}

}  // namespace kinds::torque_map

}  // namespace photorque
