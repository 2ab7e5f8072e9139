#include "raytrace/tracing/tracer.h"

#include <atomic>
#include <bit>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "core/errors.h"
#include "core/numerics/random.h"
#include "core/parallel.h"
#include "raytrace/receiver.h"
#include "raytrace/tracing/find_hits.h"
#include "raytrace/tracing/interaction.h"
#include "raytrace/tracing/launch.h"

namespace photorque {

namespace {

// Precomputed data of one beam.
struct BeamPlan {
  const Beam* beam;
  LaunchPlan launch;           // of the rays of one replicate: a power of two, at least ray_block
  uint64_t first_batch;        // index among the batches of a replicate
  BandValues power_per_ray_W;  // so that each replicate carries the full power of the beam
  double watt_per_ray;
};

// Sums of one part of the work.
struct TraceSums {
  PowerBalanceSums power_balance;
  std::vector<std::vector<double>> receivers;
  uint64_t segments = 0;

  TraceSums(size_t instances, std::span<const Receiver* const> all) {
    power_balance.absorbed_lanes_W.assign(instances, {});
    for (const Receiver* receiver : all) receivers.emplace_back(receiver->bins(), 0.0);
  }
  // Adds everything except the receivers' bins.
  void add_balance(const TraceSums& other) {
    power_balance.add(other.power_balance);
    segments += other.segments;
  }
};

// Follows batches of rays to their end. Used by one thread at a time; owns the scratch memory.
class BatchTracer {
 public:
  // All three arguments must outlive this object.
  BatchTracer(const TraceableScene::Data& scene, std::span<const Receiver* const> receivers,
              const TraceOptions& options);

  // Follows batch `batch` of a beam and replicate with the Sobol sequence `stream`, and adds the
  // results to `sums`.
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

BatchTracer::BatchTracer(const TraceableScene::Data& scene,
                         std::span<const Receiver* const> receivers, const TraceOptions& options)
    : scene_(scene),
      receivers_(receivers),
      options_(options),
      hits_(std::make_unique<HitBuffer>(scene.scene.bands.count())) {}

void BatchTracer::run(const BeamPlan& plan, const SobolStream& stream, uint32_t batch,
                      const HitOrigin& origin, TraceSums& sums) {
  sums_ = &sums;
  origin_ = origin;
  context_ = {&scene_, stream, 0, options_.cutoff * plan.watt_per_ray};
  launch(*plan.beam->emitter, plan.launch, stream, batch, launched_);
  next_.clear();
  trace_bounce({launched_.rays, launched_.order}, plan.power_per_ray_W.data(), 0,
               Coherence::coherent);
  for (context_.depth = 1; !next_.rays.empty() && context_.depth < options_.max_depth;
       ++context_.depth) {
    std::swap(current_, next_);
    next_.clear();
    trace_bounce({current_.rays, {}}, current_.power_W.data(), bands(), Coherence::incoherent);
  }
  truncate();
}

// Traces all rays once. Ray i has the powers power_W[i · stride …] per band.
void BatchTracer::trace_bounce(const RayList& rays, const double* power_W, int stride,
                               Coherence coherence) {
  sums_->segments += rays.size();
  for (size_t begin = 0; begin < rays.size(); begin += Hits::capacity) {
    const RayList some = rays.part(begin, Hits::capacity);
    const double* power = power_W + begin * static_cast<size_t>(stride);
    find_hits(scene_, some, coherence, *hits_);
    drop_misses(some, power, stride);
    if (hits_->hits.count == 0) continue;
    locate_hits(scene_, context_.depth, *hits_);
    interact(context_, *hits_, sums_->power_balance, next_);
    for (size_t r = 0; r < receivers_.size(); ++r) {
      receivers_[r]->score(hits_->hits, sums_->receivers[r]);
    }
    if (options_.observe) options_.observe(origin_, hits_->hits);
  }
}

// Books the rays that hit nothing as escaped, removes their rows, and assigns the others their
// powers.
void BatchTracer::drop_misses(const RayList& rays, const double* power_W, int stride) {
  Hits& hits = hits_->hits;
  const bool all = compact(*hits_, kept_) == static_cast<int>(rays.size());
  if (!all) {
    int at = 0;
    for (int i = 0; i < static_cast<int>(rays.size()); ++i) {
      if (at < hits.count && kept_[at] == i) {
        ++at;
      } else {
        escape(rays[static_cast<size_t>(i)], power_W + i * stride);
      }
    }
  }
  for (int b = 0; b < hits.bands; ++b) {
    double* incident = hits.incident_W[b].data();
    if (stride == 0) {
      std::fill_n(incident, hits.count, power_W[b]);
    } else {
      for (int i = 0; i < hits.count; ++i) {
        incident[i] = power_W[(all ? i : kept_[i]) * stride + b];
      }
    }
  }
}

double BatchTracer::total_W(const double* power_W) const {
  double sum = 0.0;
  for (int b = 0; b < bands(); ++b) sum += power_W[b];
  return sum;
}

void BatchTracer::escape(const Ray& ray, const double* power_W) {
  const double power = total_W(power_W);
  sums_->power_balance.escaped_W += power;
  if (context_.depth > 0) leave(ray, power);
}

void BatchTracer::leave(const Ray& ray, double power_W) {
  const Vec3 direction(ray.direction[0], ray.direction[1], ray.direction[2]);
  const Vec3 origin(ray.origin_m[0], ray.origin_m[1], ray.origin_m[2]);
  sums_->power_balance.release(context_.scene->centre_m + origin, direction, power_W);
}

// Books the power of the remaining rays as truncated, at the depth limit.
void BatchTracer::truncate() {
  for (size_t i = 0; i < next_.rays.size(); ++i) {
    const double power = total_W(&next_.power_W[i * static_cast<size_t>(bands())]);
    sums_->power_balance.truncated_W += power;
    leave(next_.rays[i], power);
  }
}

// Plan of one trace, equal for every replicate.
struct Plan {
  std::vector<BeamPlan> beams;
  uint64_t batches = 0;  // per replicate
  uint64_t rays = 0;     // over all replicates
  double emitted_W = 0.0;
  double sent_W = 0.0;  // part of emitted_W: without parallel light that meets nothing
};

// Distributes the rays to the beams in proportion to the sent power, rounded up to powers of two:
// Sobol sequences are most uniform at complete powers of two.
Plan make_plan(const TraceableScene::Data& scene, const RigidTransform& lab_from_body,
               std::span<const Beam> beams, const TraceOptions& options) {
  Plan plan;
  const RigidTransform body_from_lab = lab_from_body.inverse();
  const double rays_per_replicate = static_cast<double>(options.rays) / options.replicates;
  std::vector<std::optional<Targets>> targets;
  std::vector<double> sent_W;
  for (const Beam& beam : beams) {
    const double power = beam.emitter->power_W();
    targets.push_back(Targets::of(*beam.emitter, body_from_lab * beam.lab_from_emitter, scene,
                                  static_cast<uint64_t>(rays_per_replicate)));
    sent_W.push_back(targets.back() ? power * targets.back()->fraction() : power);
    plan.emitted_W += power;
    plan.sent_W += sent_W.back();
  }
  for (size_t i = 0; i < beams.size(); ++i) {
    const Beam& beam = beams[i];
    const double power = sent_W[i];
    const double wanted = rays_per_replicate * power / plan.sent_W;
    const uint64_t capped = static_cast<uint64_t>(std::min(wanted, 0x1p31));
    const uint32_t rays =
        std::bit_ceil(std::max<uint32_t>(static_cast<uint32_t>(capped), ray_block));
    BeamPlan planned{&beam,
                     plan_launch(*beam.emitter, body_from_lab * beam.lab_from_emitter, scene,
                                 std::countr_zero(rays), std::move(targets[i])),
                     plan.batches, band_fractions(beam.spectrum, scene.scene.bands), power / rays};
    double all_bands_W = 0.0;
    for (double& band : planned.power_per_ray_W) all_bands_W += band;
    for (double& band : planned.power_per_ray_W) band *= planned.watt_per_ray / all_bands_W;
    plan.batches += planned.launch.cells.cells();
    plan.rays += static_cast<uint64_t>(rays) * static_cast<uint64_t>(options.replicates);
    plan.beams.push_back(std::move(planned));
  }
  return plan;
}

// Number of parts into which the batches of one replicate are divided. It is fixed, so that sums do
// not depend on the number of threads.
constexpr uint64_t max_parts = 4;

TraceSums trace_part(BatchTracer& tracer, size_t instances, const Plan& plan,
                     std::span<const Receiver* const> receivers, uint64_t seed, size_t item,
                     uint64_t parts, const std::function<void()>& batch_done) {
  const uint64_t replicate = item / parts, part = item % parts;
  const uint64_t first_batch = plan.batches * part / parts;
  const uint64_t end_batch = plan.batches * (part + 1) / parts;
  TraceSums sums(instances, receivers);
  for (size_t b = 0; b < plan.beams.size(); ++b) {
    const BeamPlan& beam = plan.beams[b];
    const SobolStream stream{seed, hash_words(b, replicate), 0};
    const uint64_t begin = std::max(first_batch, beam.first_batch);
    const uint64_t end = std::min(end_batch, beam.first_batch + beam.launch.cells.cells());
    for (uint64_t batch = begin; batch < end; ++batch) {
      tracer.run(beam, stream, static_cast<uint32_t>(batch - beam.first_batch), {item, b}, sums);
      batch_done();
    }
  }
  return sums;
}

// Sums of each replicate, added from its parts in the order of the parts. A part is released as
// soon as it has been added, so that memory holds little more than the replicates for any number of
// parts.
class Replicates {
 public:
  Replicates(size_t count, uint64_t parts, size_t instances,
             std::span<const Receiver* const> receivers)
      : parts_(parts), replicates_(count) {
    for (Replicate& one : replicates_) {
      one.sums = TraceSums(instances, {});
    }
    for (const Receiver* receiver : receivers) {
      bins_.push_back({receiver->bins(), static_cast<int>(count), {}});
      bins_.back().sums.assign(count * receiver->bins(), 0.0);
    }
  }

  // Thread-safe.
  void add(size_t item, TraceSums sums) {
    Replicate& one = replicates_[item / parts_];
    const std::lock_guard lock(one.mutex);
    one.waiting.emplace(item % parts_, std::move(sums));
    for (auto next = one.waiting.find(one.next); next != one.waiting.end();
         next = one.waiting.find(++one.next)) {
      join(item / parts_, next->second);
      one.waiting.erase(next);
    }
  }

  std::vector<TraceSums> totals() {
    std::vector<TraceSums> all;
    for (Replicate& one : replicates_) all.push_back(std::move(one.sums));
    return all;
  }
  std::vector<BinSums> bins() { return std::move(bins_); }

 private:
  struct Replicate {
    std::mutex mutex;
    uint64_t next = 0;
    std::map<uint64_t, TraceSums> waiting;
    TraceSums sums{0, {}};
  };

  void join(size_t replicate, const TraceSums& part) {
    replicates_[replicate].sums.add_balance(part);
    for (size_t i = 0; i < bins_.size(); ++i) {
      double* into = bins_[i].sums.data() + replicate * bins_[i].bins;
      for (size_t b = 0; b < bins_[i].bins; ++b) into[b] += part.receivers[i][b];
    }
  }

  uint64_t parts_;
  std::vector<Replicate> replicates_;
  std::vector<BinSums> bins_;
};

PowerBalance make_power_balance(const std::vector<TraceSums>& replicates, const Plan& plan) {
  std::vector<double> values(replicates.size());
  const auto estimate = [&](const std::function<double(const PowerBalanceSums&)>& pick) {
    for (size_t r = 0; r < values.size(); ++r) values[r] = pick(replicates[r].power_balance);
    return estimate_from_replicates(values);
  };
  const auto absorbed = [](const PowerBalanceSums& s) {
    double sum = 0.0;
    for (size_t i = 0; i < s.absorbed_lanes_W.size(); ++i) sum += s.absorbed_W(i);
    return sum;
  };
  PowerBalance power_balance;
  power_balance.emitted_W = plan.emitted_W;
  power_balance.absorbed_W = estimate(absorbed);
  power_balance.escaped_W = estimate(
      [&](const PowerBalanceSums& s) { return plan.emitted_W - plan.sent_W + s.escaped_W; });
  power_balance.truncated_W = estimate([](const PowerBalanceSums& s) { return s.truncated_W; });
  for (size_t i = 0; i < replicates[0].power_balance.absorbed_lanes_W.size(); ++i) {
    power_balance.absorbed_by_instance_W.push_back(
        estimate([i](const PowerBalanceSums& s) { return s.absorbed_W(i); }));
  }
  for (size_t k = 0; k < 3; ++k) {
    power_balance.force_N[k] =
        estimate([k](const PowerBalanceSums& s) { return s.momentum_in[k] - s.momentum_out[k]; });
    power_balance.torque_N_m[k] = estimate(
        [k](const PowerBalanceSums& s) { return s.momentum_in[3 + k] - s.momentum_out[3 + k]; });
  }
  for (const TraceSums& replicate : replicates) {
    const PowerBalanceSums& s = replicate.power_balance;
    const double gap = std::abs(plan.sent_W - absorbed(s) - s.escaped_W - s.truncated_W);
    power_balance.closure = std::max(power_balance.closure, gap / plan.emitted_W);
  }
  return power_balance;
}

void check(const TraceOptions& options, std::span<const Beam> beams) {
  const auto refuse = [](const std::string& key, double found, const std::string& expected) {
    throw InputError({"trace"}, key, std::to_string(found), expected);
  };
  if (beams.empty()) throw InputError({"trace"}, "source", "none", "at least one source");
  if (options.replicates < 8 || options.replicates > 1024) {
    refuse("replicates", options.replicates, "8 to 1024");
  }
  // A Sobol sequence has at most 2^31 points.
  const uint64_t max_rays = static_cast<uint64_t>(options.replicates) << 31;
  if (options.rays < 1 || options.rays > max_rays) {
    refuse("rays", static_cast<double>(options.rays),
           "1 to 2^31 for each of the replicates, " + std::to_string(max_rays));
  }
  if (options.max_depth < 1 || options.max_depth > 65535) {
    refuse("max_depth", options.max_depth, "1 to 65535");
  }
  if (!(options.cutoff >= 0.0 && options.cutoff < 1.0)) refuse("cutoff", options.cutoff, "0 to 1");
  for (const Beam& beam : beams) {
    if (!(beam.emitter->power_W() > 0.0)) {
      throw InputError({"trace"}, "source \"" + beam.name + "\"", "light of no power",
                       "a larger power_W or irradiance_W_m2");
    }
  }
}

}  // namespace

uint64_t trace_bytes_per_bin(int replicates, int threads) {
  // Two parts of the work per thread: one in progress and one that waits to be added.
  constexpr int means_and_pictures = 4;
  const auto numbers = replicates + replicates / 2 + 2 * threads + means_and_pictures;
  return sizeof(double) * static_cast<uint64_t>(numbers);
}

size_t trace_parts(const TraceOptions& options) {
  return max_parts * static_cast<size_t>(options.replicates);
}

TraceResult trace(const TraceableScene& scene, const RigidTransform& lab_from_body,
                  std::span<const Beam> beams, std::span<const Receiver* const> receivers,
                  const TraceOptions& options) {
  check(options, beams);
  const TraceableScene::Data& data = scene.data();
  const Plan plan = make_plan(data, lab_from_body, beams, options);

  const uint64_t parts = std::min(max_parts, plan.batches);
  const size_t replicates = static_cast<size_t>(options.replicates);
  const size_t items = replicates * parts;
  Replicates sums(replicates, parts, data.scene.instances.size(), receivers);
  std::atomic<uint64_t> finished = 0;
  const uint64_t batches = plan.batches * replicates;
  const auto batch_done = [&] {
    const uint64_t now = ++finished;
    if (options.progress) options.progress(static_cast<double>(now) / static_cast<double>(batches));
  };
  parallel_for(items, options.threads, [&](size_t item) {
    BatchTracer tracer(data, receivers, options);
    sums.add(item, trace_part(tracer, data.scene.instances.size(), plan, receivers, options.seed,
                              item, parts, batch_done));
  });

  TraceResult result;
  const std::vector<TraceSums> by_replicate = sums.totals();
  for (const TraceSums& replicate : by_replicate) result.segments += replicate.segments;
  result.sums = sums.bins();
  result.power_balance = make_power_balance(by_replicate, plan);
  result.rays = plan.rays;
  result.sent_W = plan.sent_W;
  return result;
}

}  // namespace photorque
