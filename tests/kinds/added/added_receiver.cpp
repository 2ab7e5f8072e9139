// A kind of receiver that the program does not have: it counts hits.
#include "receivers/kind.h"

namespace photorque::kinds::added_receiver {
namespace {

class HitCounter final : public Receiver {
 public:
  size_t bins() const override { return 1; }
  void score(const Hits& hits, std::span<double> sums) const override { sums[0] += hits.count; }
  Product product(const BinSums&) const override { return {}; }
};

}  // namespace

ReceiverKind kind() {
  return {"added_receiver", "Counts hits", [](const Settings&, const Scene&) -> MadeReceiver {
            return {.receiver = std::make_shared<const HitCounter>()};
          }};
}

}  // namespace photorque::kinds::added_receiver
