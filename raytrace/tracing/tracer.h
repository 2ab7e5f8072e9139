// Forward ray tracing of light from beams through a scene into receivers.
//
// Method: every emitter has `replicates` independent Owen-scrambled Sobol sequences, and each ray
// is followed from surface to surface. Parallel light is sent only where it can meet the scene (see
// tracing/targets.h); the rest counts as escaped. At a hit the absorbed fraction of the ray's power
// stays in the surface. One of the other lobes, drawn in proportion to its power, carries all of
// the rest, so that
//   emitted = absorbed + escaped + truncated
// holds for every ray, not only on average. The force of a hit is the arriving momentum minus the
// expected leaving momentum over all lobes. Standard errors come from the spread of the replicates.
// The results have the same bits for any number of threads.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "raytrace/emitter.h"
#include "raytrace/receiver.h"
#include "raytrace/scene.h"

namespace photorque {

// A scene with its bounding volume hierarchy. Build it once and trace at many attitudes: the
// emitters move, the scene does not. Immutable after construction.
class TraceableScene {
 public:
  // Keeps a copy of the scene. Throws InputError for indices out of range or non-finite vertices.
  // `leak_safe` makes rays watertight along shared edges and costs 12–20 % of the speed.
  explicit TraceableScene(Scene scene, bool leak_safe = true);
  ~TraceableScene();
  TraceableScene(TraceableScene&&) noexcept;

  // The copy of the scene.
  const Scene& scene() const;

  struct Data;
  const Data& data() const { return *data_; }

 private:
  std::unique_ptr<Data> data_;
};

// Origin of the hits that are observed together.
struct HitOrigin {
  size_t part = 0;  // part of the work, below trace_parts()
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
  std::function<void(double)> progress = {};  // called with the finished fraction, from any thread
  // Called with all hits, from any thread. Hits of one part of the work come from one thread at a
  // time, in an order that does not depend on the number of threads. Their powers are those of one
  // replicate, which carries all of the light.
  std::function<void(const HitOrigin&, const Hits&)> observe = {};
};

// Balance of the power over all bands. emitted − absorbed − escaped − truncated is zero to 1e-12 of
// emitted; `closure` is the deviation.
struct PowerBalance {
  double emitted_W = 0.0;
  Estimate absorbed_W;
  Estimate escaped_W;
  Estimate truncated_W;
  std::vector<Estimate> absorbed_by_instance_W;
  double closure = 0.0;  // |emitted − absorbed − escaped − truncated| / emitted
  // Force and torque about the body origin (body frame) from the rays alone: momentum at their
  // first hit minus momentum when they escape or are truncated. The sum of Hits::force_N over all
  // surfaces has the same expectation and less noise; every run compares the two.
  std::array<Estimate, 3> force_N;
  std::array<Estimate, 3> torque_N_m;
};

struct TraceResult {
  PowerBalance power_balance;
  std::vector<BinSums> sums;  // one per receiver, in the given order
  uint64_t rays = 0;          // number of rays from the sources
  // power of these rays: emitted power minus parallel light that meets nothing
  double sent_W = 0.0;
  uint64_t segments = 0;  // number of traced ray segments, including bounces
};

// Estimated memory [bytes] per bin of a receiver during a trace and its evaluation: one number per
// replicate, the sums in progress on each thread, and the means, errors and pictures.
uint64_t trace_bytes_per_bin(int replicates, int threads);

// Maximum number of parts into which a trace with these options is divided.
size_t trace_parts(const TraceOptions& options);

// Traces `beams` to the scene at the attitude `lab_from_body`. Throws InputError for options out of
// range and for an empty list of beams.
TraceResult trace(const TraceableScene& scene, const RigidTransform& lab_from_body,
                  std::span<const Beam> beams, std::span<const Receiver* const> receivers,
                  const TraceOptions& options);

}  // namespace photorque
