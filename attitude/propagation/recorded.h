// A run that its caller steps, and its recording.
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
// A process that runs beside the motion looks at the step and exchanges with motion() between
// advance() and record(). A run that is broken off goes on from a snapshot, its results the same to
// the last bit; runs with a commander cannot.
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
  // One step of the motion; false when the run has ended.
  bool advance() { return propagator_.advance(); }
  // Records the rows that the last step passed, as far as `beside` is known.
  void record();
  // After the last step.
  PropagationResult result();

  // After a step; or before the first, from what an equal run kept.
  void keep(Snapshot& snapshot);

 private:
  // The times at which a run is looked at: its rows and, for a camera with latency, what it sees in
  // them. Of two equal times what is seen comes first. What lies before the start is looked at
  // there, `before_s` too late.
  struct Look {
    double time_s;
    bool is_row;
    double before_s = 0.0;
  };
  static std::vector<Look> looks(const PropagationRun& run, double delay_s);
  void take_in(const Samples& samples);
  void hand_on();
  void record(const Samples& samples);
  void record(const Look& look, const std::vector<double>& y, const PlatformState& state,
              const Dynamics::Instants& now, int lane);

  const PowerHistory* beside_;
  std::function<void(double)> progress_;
  Dynamics dynamics_;
  double delay_s_;
  std::vector<Look> times_;
  size_t rows_, thinning_;
  Recorder recorder_;
  TimeHistory history_;
  Propagator propagator_;
  Sampler sampler_;
  std::optional<LiveInstruments> instruments_;
  std::vector<PlatformState> states_;
  std::deque<Quat> on_the_way_;  // seen by the camera, not yet reported
  std::deque<Samples> waiting_;  // until `beside` is known
};

}  // namespace photorque
