// A run whose integration steps the caller makes one by one, with its recording.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "attitude/propagation/power_history.h"
#include "attitude/propagation/run.h"
#include "attitude/propagation/sampling.h"
#include "attitude/propagation/time_history.h"

namespace photorque {

//   RecordedRun recorded(run, progress);
//   while (recorded.advance()) recorded.record();
//   PropagationResult result = recorded.result();
//
// A simulation that is coupled to the motion exchanges data with motion() between advance() and
// record(). An interrupted run continues from a snapshot with bitwise equal results, except runs
// with a commander.
class RecordedRun {
 public:
  // `beside`: the history of a power system that is simulated together with the motion. The caller
  // appends to it, and the recording waits for it. It then provides battery current, array power,
  // charge and the time at which the battery is empty. All must outlive the run.
  RecordedRun(const PropagationRun& run, std::function<void(double)> progress,
              const PowerHistory* beside = nullptr);
  RecordedRun(const RecordedRun&) = delete;
  RecordedRun& operator=(const RecordedRun&) = delete;

  Propagator& motion() { return propagator_; }
  // Makes one integration step; false when the run has ended.
  bool advance() { return propagator_.advance(); }
  // Records the rows within the last step, as far as the history `beside` extends.
  void record();
  // The results; call it after the last step. If an event ended the run between two rows, the
  // history ends with the state at the event.
  PropagationResult result();

  // Stores the state after a step, or restores it before the first step of an equal run.
  void keep(Snapshot& snapshot);

 private:
  void take_in(const Samples& samples);
  void hand_on();
  void record(const Samples& samples);
  Dynamics::Instants instants_at(const Samples& samples) const;
  PlatformState state_of(const Samples& samples, int lane) const;
  PlatformState recorded_end();
  void record(const std::vector<double>& y, const PlatformState& state,
              const Dynamics::Instants& now, int lane);

  const PowerHistory* beside_;
  std::function<void(double)> progress_;
  Dynamics dynamics_;
  Schedule given_;  // commands when they are given, before any latency of actuators
  LateCamera camera_;
  size_t rows_, thinning_;
  Recorder recorder_;
  TimeHistory history_;
  Excursion excursion_;
  Propagator propagator_;
  Sampler sampler_;
  std::optional<LiveInstruments> instruments_;
  std::vector<PlatformState> states_;
  std::deque<Samples> waiting_;  // until `beside` extends to their times
};

}  // namespace photorque
