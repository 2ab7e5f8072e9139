#include "raytrace/tracing/batch_tracer.h"

namespace photorque {

BatchTracer::BatchTracer(const TraceableScene::Data& scene,
                         std::span<const Receiver* const> receivers, const TraceOptions& options)
    : scene_(scene),
      receivers_(receivers),
      options_(options),
      hits_(std::make_unique<HitBuffer>()) {
  hits_->hits.bands = scene.scene.bands.count();
  for (size_t k = 0; k < 3; ++k) hits_->hits.direction[k] = hits_->ray[3 + k].data();
}

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

// Ray i has the powers power_W[i · stride …].
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

// Lets the rays that hit nothing escape, closes the gaps that they leave, and gives the others
// their powers.
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
  sums_->power_balance.release(origin, direction, power_W);
}

// What is still under way at the depth limit.
void BatchTracer::truncate() {
  for (size_t i = 0; i < next_.rays.size(); ++i) {
    const double power = total_W(&next_.power_W[i * static_cast<size_t>(bands())]);
    sums_->power_balance.truncated_W += power;
    leave(next_.rays[i], power);
  }
}

}  // namespace photorque
