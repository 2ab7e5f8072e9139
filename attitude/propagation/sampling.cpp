#include "attitude/propagation/sampling.h"

#include <algorithm>

#include "core/snapshot.h"

namespace photorque {

void Samples::keep(Snapshot& snapshot, size_t components, size_t times) {
  snapshot.at_most(first, times);
  snapshot.at_most(count, std::min<size_t>(Lanes::count, times - first));
  snapshot(time_s, held);
  y.resize(components);
  snapshot.fixed(y);
}

Sampler::Sampler(const Propagator& propagator, size_t count, std::function<double(size_t)> time_s,
                 std::function<void(const Samples&)> sink)
    : propagator_(propagator),
      count_(count),
      time_s_(std::move(time_s)),
      sink_(std::move(sink)),
      y_(static_cast<size_t>(propagator.dynamics().size())),
      derivatives_(
          propagator.sensitivity() ? y_.size() * propagator.sensitivity()->variables().size() : 0) {
  samples_.y = y_;
  samples_.derivatives = derivatives_;
}

void Sampler::flush() {
  if (samples_.count == 0) return;
  const int last = samples_.count - 1;
  const auto repeat = [&](Lanes& x) {
    for (int i = samples_.count; i < Lanes::count; ++i) x.set(i, x[last]);
  };
  repeat(samples_.time_s);
  for (Lanes& x : samples_.y) repeat(x);
  for (Lanes& x : samples_.derivatives) repeat(x);
  for (int i = samples_.count; i < Lanes::count; ++i) {
    samples_.held[static_cast<size_t>(i)] = samples_.held[static_cast<size_t>(last)];
  }
  sink_(samples_);
  samples_.first += static_cast<size_t>(samples_.count);
  samples_.count = 0;
}

// Appends the states at the first `batch` times.
void Sampler::file(const Lanes& times_s, int batch) {
  // A batch of eight fills all lanes, so it is evaluated directly into the samples.
  const bool is_whole = batch == Lanes::count;
  propagator_.dense(times_s, is_whole ? samples_.y.data() : y_.data());
  if (!derivatives_.empty()) {
    propagator_.dense_derivatives(times_s,
                                  is_whole ? samples_.derivatives.data() : derivatives_.data());
  }
  if (is_whole) {
    samples_.time_s = times_s;
    samples_.held.fill(propagator_.held());
    samples_.count = batch;
  }
  for (int i = 0; i < batch && !is_whole; ++i) {
    const int lane = samples_.count++;
    samples_.time_s.set(lane, times_s[i]);
    samples_.held[static_cast<size_t>(lane)] = propagator_.held();
    for (size_t c = 0; c < y_.size(); ++c) samples_.y[c].set(lane, y_[c][i]);
    for (size_t c = 0; c < derivatives_.size(); ++c) {
      samples_.derivatives[c].set(lane, derivatives_[c][i]);
    }
  }
}

// Times within one step share one evaluation of the polynomial. The lanes are then copied one by
// one, because eight samples may come from several short steps.
void Sampler::take(bool including_end) {
  const double end_s = propagator_.step_end_s();
  const auto inside = [&](double t_s) { return including_end ? t_s <= end_s : t_s < end_s; };
  while (next_ < count_ && inside(time_s_(next_))) {
    Lanes times_s = time_s_(next_);
    int batch = 0;
    for (; batch < Lanes::count - samples_.count && next_ < count_ && inside(time_s_(next_));
         ++batch) {
      times_s.set(batch, time_s_(next_++));
    }
    file(times_s, batch);
    if (samples_.count == Lanes::count) flush();
  }
}

void Sampler::follow() {
  take(false);
}

void Sampler::finish() {
  take(true);
  flush();
}

void Sampler::keep(Snapshot& snapshot) {
  snapshot.expect(count_);
  snapshot.at_most(next_, count_);
  samples_.keep(snapshot, y_.size(), count_);
}

void sample(Propagator& propagator, size_t count, const std::function<double(size_t)>& time_s,
            const std::function<void(const Samples&)>& sink) {
  Sampler sampler(propagator, count, time_s, sink);
  while (propagator.advance()) sampler.follow();
  sampler.finish();
}

}  // namespace photorque
