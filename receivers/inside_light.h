// Light on the inner side of closed bodies, which passed through their cracks.
#pragma once

#include <string>
#include <vector>

#include "raytrace/receiver.h"
#include "raytrace/scene.h"

namespace photorque {

// Watches the instances of meshes that enclose something (Mesh::encloses) and let no light through.
// No light belongs on the inside of such a body unless a lamp stands in it. Bins: per instance, the
// power that arrives on its outer side and on its inner side [W], bounces included.
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
  // On the inside of all together.
  Estimate inside_W(const BinSums& sums) const;

 private:
  std::vector<uint32_t> instances_;
  std::vector<uint32_t> part_of_instance_;  // or the number of parts, for those not watched
};

// One line of text: how much of `emitted_W` reached the inside of which parts, and whether by
// cracks or because a part is turned inside out. Empty where it is less than a millionth.
std::string describe_inside_light(const Scene& scene,
                                  const std::vector<InsideLightReceiver::Part>& lit,
                                  double emitted_W);

}  // namespace photorque
