// Shared by the optical commands: experiment → trace → products → files.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/product.h"
#include "core/provenance.h"
#include "receivers/flux_map.h"
#include "receivers/inside_light.h"
#include "receivers/wrench/wrench.h"
#include "scenes/experiment/experiment.h"
#include "tools/runs/console.h"
#include "tools/runs/direct_light.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

// The result of a run: the trace, the direct light of its flux maps gathered where possible.
struct OpticalResult : TraceResult {
  DirectRoute direct;
  double wall_s = 0.0;
  double worst_bin_error = 0.0;  // see worst_bin_error()
};

// An experiment made ready to trace: its scene built once, its receivers, always a wrench over the
// whole scene ("body", added if the experiment names none), and a watch over closed parts.
class OpticalRun {
 public:
  // Reads the experiment; prints its notices and the shapes of its sources.
  OpticalRun(const RunOptions& options, const Console& console);

  const Experiment& experiment() const { return experiment_; }
  const TraceableScene& scene() const { return scene_; }
  const Provenance& provenance() const { return provenance_; }
  // Provenance with a warning for each self-check of this result that fails.
  Provenance provenance(const OpticalResult& result) const;
  // One line for each self-check that is off by more than four of its standard errors: the two
  // routes to direct light and to force and torque; or power that was lost.
  std::vector<std::string> warnings(const OpticalResult& result) const;

  // Adds a warning for all later runs.
  void warn(std::string line) { experiment_.warnings.push_back(std::move(line)); }

  // Adds one that is not in the experiment file, for all later runs; returns its index.
  size_t add_receiver(NamedReceiver receiver);

  // Leaves out, for all later runs, the lamps that are not wanted.
  void keep_beams(const std::function<bool(const Beam&)>& wanted);

  // Traces at an attitude, with the options of the experiment but, if given, another number of
  // rays; goes on with twice the rays until the experiment's target error or time is reached.
  OpticalResult run(const RigidTransform& lab_from_body,
                    const std::function<void(double)>& progress,
                    std::optional<uint64_t> rays = {}) const;

  // The place of a receiver among experiment().receivers and TraceResult::sums.
  size_t wrench_index() const { return wrench_; }
  // The place of the first receiver that is a flux map.
  std::optional<size_t> first_flux_map() const;
  // The flux map called `name`, or the first one if `name` is empty. InputError that names `key` if
  // there is none.
  size_t flux_map_index(const std::string& name, const std::string& key = "array.receiver") const;

  const WrenchReceiver& wrench() const;
  const FluxMapReceiver& flux_map(size_t index) const;
  // Light on the inside of closed parts, as a line of text; empty if there is none.
  std::string inside_light(const TraceResult& result) const;

  // Power balance, shapes of the sources, and the product of every receiver.
  Product product(const OpticalResult& result) const;

 private:
  std::shared_ptr<const WrenchGather> bodies() const;

  Experiment experiment_;
  TraceableScene scene_;
  Provenance provenance_;
  size_t wrench_ = 0;
  std::shared_ptr<const InsideLightReceiver> inside_light_;  // null where no part is closed
  size_t inside_index_ = 0;                                  // its place among the receivers
  int threads_ = 0;
  // Gathers the wrench of direct light, created on first use; null inside where rays must do.
  mutable std::optional<std::shared_ptr<const WrenchGather>> bodies_;
  std::unique_ptr<std::mutex> bodies_mutex_ = std::make_unique<std::mutex>();
};

// One of several attitudes of a run, as it was traced.
struct TracedNode {
  const OpticalRun& run;
  size_t nodes;  // how many there are
  RigidTransform lab_from_body;
  const OpticalResult& light;
  std::optional<Estimate> electric_W = {};  // of the array, where there is one
};
// In the order of the nodes.
using NodeWatch = std::function<void(const TracedNode&)>;

// The warnings of several runs, each once: at most three in full, then how many more there are.
class Warnings {
 public:
  // `where` names the run: "tilt 5 deg, heading 0".
  void add(const std::vector<std::string>& warnings, const std::string& where);
  // Prints the results, and adds them to the output.
  void print(const Console& console) const;
  Provenance into(Provenance provenance) const;

 private:
  std::vector<std::string> lines() const;

  std::vector<std::string> first_;
  size_t count_ = 0;
};

// The power balance and the effects of the light, as text.
void print_trace(const Console& console, const OpticalRun& run, const OpticalResult& result);

// Adds the items of `more` to `product`.
void append(Product& product, Product more);

}  // namespace photorque
