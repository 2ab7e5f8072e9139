// Light from beams through a scene into receivers, by forward ray tracing.
//
// Method: for every emitter, `replicates` independent Owen-scrambled Sobol sequences; each ray is
// followed from surface to surface. Parallel light is sent only where it can meet the scene (see
// tracing/targets.h); the rest of it counts as escaped. At a hit the absorbed fraction of its power
// stays there and one of the other lobes, drawn in proportion to its power, carries all the rest
// on, so that
//   emitted = absorbed + escaped + truncated
// holds for every ray, not only on average. The force of a hit is the momentum that arrives minus
// the expectation of what leaves over all lobes. Standard errors come from the spread of the
// replicates. Results are the same bits at any number of threads.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "raytrace/emitter.h"
#include "raytrace/receiver.h"
#include "raytrace/scene.h"

namespace photorque {

// A scene made ready for rays (a bounding volume hierarchy). Build once, trace at many attitudes:
// the emitters move, not the scene. Immutable after construction.
class TraceableScene {
 public:
  // Keeps its own copy of the scene. Throws InputError for indices out of range or vertices that
  // are not finite. `leak_safe` makes rays watertight along shared edges at 12–20 % of the speed.
  explicit TraceableScene(Scene scene, bool leak_safe = true);
  ~TraceableScene();
  TraceableScene(TraceableScene&&) noexcept;

  const Scene& scene() const;

  struct Data;
  const Data& data() const { return *data_; }

 private:
  std::unique_ptr<Data> data_;
};

// Where the hits that are observed together come from.
struct HitOrigin {
  size_t part = 0;  // of the work, below trace_parts()
  size_t beam = 0;  // index into the beams
};

struct TraceOptions {
  uint64_t rays =
      1ull << 23;       // in total; rounded up per beam and replicate to a power of two ≥ 256
  int replicates = 16;  // ≥ 8
  uint64_t seed = 1;
  int max_depth = 64;    // interactions after which a ray's remaining power is truncated, ≥ 1
  double cutoff = 1e-9;  // truncate rays with less than this fraction of their first power
  int threads = 0;       // 0: all
  std::function<void(double)> progress;  // called with the finished fraction, from any thread
  // Called with all hits, from any thread; those of one part of the work come from one thread at a
  // time, in an order that does not depend on the number of threads. Their powers are those of one
  // replicate, which carries all of the light.
  std::function<void(const HitOrigin&, const Hits&)> observe = {};
};

// Where the power went. Sums over bands; emitted − absorbed − escaped − truncated is zero to 1e-12
// of emitted; `closure` is the deviation.
struct PowerBalance {
  double emitted_W = 0.0;
  Estimate absorbed_W;
  Estimate escaped_W;
  Estimate truncated_W;
  std::vector<Estimate> absorbed_by_instance_W;
  double closure = 0.0;  // |emitted − absorbed − escaped − truncated| / emitted
  // Force and torque about the body origin (body frame) from the rays alone: momentum at their
  // first hit minus momentum as they escaped or were truncated. The sum of Hits::force_N over all
  // surfaces has the same expectation by another route, with less noise: a check in every run.
  std::array<Estimate, 3> force_N;
  std::array<Estimate, 3> torque_N_m;
};

struct TraceResult {
  PowerBalance power_balance;
  std::vector<BinSums> sums;  // one per receiver, in their order
  uint64_t rays = 0;          // traced from the sources
  double sent_W = 0.0;        // their power: emitted, but for parallel light that meets nothing
  uint64_t segments = 0;      // traced, bounces included
};

// About how much memory [bytes] each of a receiver's bins takes in a trace and in what is made of
// it: a number per replicate, for what one part of the work adds up on each thread, and some of the
// means, errors and pictures after it.
uint64_t trace_bytes_per_bin(int replicates, int threads);

// The largest number of parts that a trace with these options is cut into.
size_t trace_parts(const TraceOptions& options);

// Traces `beams` onto the scene at the attitude `lab_from_body`. Throws InputError for options out
// of range and for no beams.
TraceResult trace(const TraceableScene& scene, const RigidTransform& lab_from_body,
                  std::span<const Beam> beams, std::span<const Receiver* const> receivers,
                  const TraceOptions& options);

}  // namespace photorque
