// Batches of rays followed from the emitter to their end. For the files of tracing only.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "raytrace/receiver.h"
#include "raytrace/tracing/find_hits.h"
#include "raytrace/tracing/interaction.h"
#include "raytrace/tracing/launch.h"
#include "raytrace/tracing/tracer.h"

namespace photorque {

// The part of the work that belongs to one beam.
struct BeamPlan {
  const Beam* beam;
  LaunchPlan launch;           // of the rays of one replicate: a power of two, at least ray_block
  uint64_t first_batch;        // its number among the batches of a replicate
  BandValues power_per_ray_W;  // so that each replicate carries the full power of the beam
  double watt_per_ray;
};

// Everything that one part of the work adds up.
struct TraceSums {
  PowerBalanceSums power_balance;
  std::vector<std::vector<double>> receivers;
  uint64_t segments = 0;

  TraceSums(size_t instances, std::span<const Receiver* const> all) {
    power_balance.absorbed_lanes_W.assign(instances, {});
    for (const Receiver* receiver : all) receivers.emplace_back(receiver->bins(), 0.0);
  }
  // All but the receivers' bins.
  void add_balance(const TraceSums& other) {
    power_balance.add(other.power_balance);
    segments += other.segments;
  }
};

// Follows batches of rays to their end. One thread at a time; owns the scratch memory.
class BatchTracer {
 public:
  // All three must outlive this.
  BatchTracer(const TraceableScene::Data& scene, std::span<const Receiver* const> receivers,
              const TraceOptions& options);

  // Follows batch `batch` of a beam and replicate, whose sequence is `stream`, and adds what it
  // does to `sums`.
  void run(const BeamPlan& plan, const SobolStream& stream, uint32_t batch, const HitOrigin& origin,
           TraceSums& sums);

 private:
  int bands() const { return hits_->hits.bands; }
  void trace_bounce(const RayList& rays, const double* power_W, int stride, Coherence coherence);
  void drop_misses(const RayList& rays, const double* power_W, int stride);
  double total_W(const double* power_W) const;
  void escape(const Ray& ray, const double* power_W);
  void leave(const Ray& ray, double power_W);
  void truncate();

  const TraceableScene::Data& scene_;
  std::span<const Receiver* const> receivers_;
  const TraceOptions& options_;
  std::unique_ptr<HitBuffer> hits_;
  LaunchBuffer launched_;
  Continuation current_, next_;
  InteractionContext context_{};
  HitOrigin origin_;
  Hits::Column<int> kept_{};
  TraceSums* sums_ = nullptr;
};

}  // namespace photorque
