#include "tools/realtime/clock.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/errors.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

// The smallest value that is at least as large as this fraction of the sorted values.
double percentile(const std::vector<float>& sorted, double fraction) {
  const double rank = std::ceil(fraction * static_cast<double>(sorted.size()));
  return sorted[static_cast<size_t>(std::max(rank, 1.0)) - 1];
}

// Complementary distribution: fraction of values above each value.
Plot::Curve beyond(const std::string& label, const std::vector<float>& sorted) {
  Plot::Curve curve;
  curve.label = label;
  const size_t count = sorted.size();
  constexpr size_t points = 400;
  for (size_t i = 0; i < points; ++i) {
    // Equally spaced in the logarithm of the fraction.
    const double fraction =
        std::pow(static_cast<double>(count), -static_cast<double>(i) / (points - 1));
    const auto left = static_cast<size_t>(std::llround(fraction * static_cast<double>(count)));
    const double value_us = 1e6 * static_cast<double>(sorted[count - std::max<size_t>(left, 1)]);
    if (value_us < 0.1) continue;  // logarithmic axis
    if (!curve.x.empty() && value_us <= curve.x.back()) continue;
    curve.x.push_back(value_us);
    curve.y.push_back(fraction);
  }
  return curve;
}

}  // namespace

int64_t monotonic_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

TickClock::TickClock(double step_s, double deadline_s, OnMiss on_miss)
    : step_ns_(1e9 * step_s), deadline_s_(deadline_s), on_miss_(on_miss) {}

int64_t TickClock::due_ns(size_t tick) const {
  return start_ns_ + slipped_ns_ + std::llround(static_cast<double>(tick) * step_ns_);
}

double TickClock::run_s(int64_t at_ns) const {
  return 1e-9 * static_cast<double>(at_ns - start_ns_ - slipped_ns_);
}

bool TickClock::served(size_t tick, int64_t now_ns, int64_t computing_ns) {
  const int64_t late_ns = now_ns - due_ns(tick);
  const double late_s = 1e-9 * static_cast<double>(late_ns);
  late_s_.push_back(static_cast<float>(late_s));
  computing_s_.push_back(static_cast<float>(1e-9 * static_cast<double>(computing_ns)));
  if (late_s <= deadline_s_) return false;
  ++missed_;
  if (on_miss_ == OnMiss::stop) {
    throw NumericalError("tick " + std::to_string(tick) + " was " + shortest(late_s) +
                         " s late, and serve.on_miss = \"stop\"");
  }
  if (on_miss_ == OnMiss::slip) slipped_ns_ += late_ns;
  return true;
}

Product TickClock::product() const {
  Product product;
  if (late_s_.empty()) return product;
  std::vector<float> late_s = late_s_, computing_s = computing_s_;
  std::ranges::sort(late_s);
  std::ranges::sort(computing_s);
  const auto put = [&](const std::string& name, double value) {
    product.quantities.push_back({name, {value, 0.0}});
  };
  put("ticks", static_cast<double>(late_s.size()));
  put("ticks_missed", static_cast<double>(missed_));
  put("slipped_s", 1e-9 * static_cast<double>(slipped_ns_));
  Table table = Table::of("deadline_percentiles", "Lateness of ticks and duration of steps");
  for (const auto& [name, sorted] : {std::pair{"lateness", &late_s}, {"computing", &computing_s}}) {
    Table::Row row = table.row().set("of", name);
    for (const auto& [suffix, fraction] :
         {std::pair{"p50", 0.5}, {"p99", 0.99}, {"p99_99", 0.9999}, {"largest", 1.0}}) {
      const double value_s = percentile(*sorted, fraction);
      put(std::string(name) + "_" + suffix + "_us", 1e6 * value_s);
      row.set(std::string(suffix) + "_us", 1e6 * value_s);
    }
  }
  product.tables.push_back(std::move(table));
  Plot plot{"deadlines", "Fraction of ticks later, and of steps longer, than a time", "time [µs]",
            "fraction of all ticks"};
  plot.x_log = plot.y_log = true;
  for (Plot::Curve curve :
       {beyond("sent after the tick", late_s), beyond("computing the step", computing_s)}) {
    if (curve.x.size() > 1) plot.curves.push_back(std::move(curve));
  }
  if (!plot.curves.empty()) product.plots.push_back(std::move(plot));
  return product;
}

}  // namespace photorque
