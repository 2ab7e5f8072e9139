// Light on the inner side of closed bodies, which entered through cracks.
#pragma once

#include <string>
#include <vector>

#include "raytrace/receiver.h"
#include "raytrace/scene.h"

namespace photorque {

// Monitors the instances of opaque meshes that enclose a volume (Mesh::encloses). Light on the
// inside of such a body is an error of the model, unless a lamp is inside. Bins: per instance, the
// power that arrives on its outer side and on its inner side [W], including bounces.
class InsideLightReceiver final : public Receiver {
 public:
  explicit InsideLightReceiver(const Scene& scene);

  size_t bins() const override { return 2 * instances_.size(); }
  void score(const Hits& hits, std::span<double> sums) const override;
  // The quantity "light_inside_closed_parts_W".
  Product product(const BinSums& sums) const override;

  struct Part {
    uint32_t instance;
    Estimate outside_W, inside_W;
  };
  // Parts with light inside, the largest power first.
  std::vector<Part> lit_inside(const BinSums& sums) const;
  // Power on the inside of all bodies together.
  Estimate inside_W(const BinSums& sums) const;

 private:
  std::vector<uint32_t> instances_;
  // The number of parts for instances that are not monitored.
  std::vector<uint32_t> part_of_instance_;
};

// One line of text: the part of `emitted_W` that reached the inside, the parts concerned, and
// whether cracks or an inside-out part are the reason. Empty below a millionth.
std::string describe_inside_light(const Scene& scene,
                                  const std::vector<InsideLightReceiver::Part>& lit,
                                  double emitted_W);

}  // namespace photorque
