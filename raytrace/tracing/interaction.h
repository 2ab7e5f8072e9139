// Interaction of rays with surfaces: absorption, choice of the lobe that continues, momentum.
#pragma once

#include <array>
#include <vector>

#include "raytrace/receiver.h"
#include "raytrace/tracing/find_hits.h"
#include "raytrace/tracing/traceable_scene_data.h"

namespace photorque {

// Rays that continue after a hit, with their power per band (ray-major:
// power_W[ray · bands + band]).
struct Continuation {
  std::vector<Ray> rays;
  std::vector<double> power_W;
  void clear() {
    rays.clear();
    power_W.clear();
  }
};

// Power [W] and momentum flow [N, N m about the body origin] of one part of the work, added in a
// fixed order.
struct PowerBalanceSums {
  double escaped_W = 0.0;
  double truncated_W = 0.0;
  std::array<double, 6> momentum_in{};   // of rays at their first hit
  std::array<double, 6> momentum_out{};  // of rays that escaped after a hit, or were truncated
  // Per instance, in four lanes that are used in turn: with a single running sum every addition
  // would wait for the one before.
  std::vector<std::array<double, 4>> absorbed_lanes_W;

  // Absorbed power of an instance [W].
  double absorbed_W(size_t instance) const;
  void add(const PowerBalanceSums& other);
  // Adds the momentum of a ray of this power that leaves the scene through `at_m`.
  void release(const Vec3& at_m, const Vec3& direction, double power_W);
  void release_momentum(const Vec3& at_m, const Vec3& force_N);
};

struct InteractionContext {
  const TraceableScene::Data* scene = nullptr;
  SobolStream stream;     // of the beam and replicate; group is set per depth
  int depth = 0;          // of all hits in the buffer
  double cutoff_W = 0.0;  // rays with less than this are truncated
};

// Processes all hits of the buffer: fills absorbed_W and force_N, adds to the power balance and
// appends the continuing rays to `next`. The component and direction of a ray come from its own
// Sobol point of group depth + 1.
void interact(const InteractionContext& context, HitBuffer& buffer, PowerBalanceSums& power_balance,
              Continuation& next);

}  // namespace photorque
