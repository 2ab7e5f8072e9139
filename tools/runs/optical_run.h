// Common functions of the optical commands: experiment → trace → products → files.
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

// Result of a run: the trace, with the direct light of its flux maps by gathering if possible.
struct OpticalResult : TraceResult {
  DirectRoute direct;
  double wall_s = 0.0;
  double worst_bin_error = 0.0;  // see worst_bin_error()
};

// An experiment prepared for tracing: its scene, its receivers, always a wrench of the whole scene
// ("body", added if the experiment has none), and a receiver for light inside closed parts.
class OpticalRun {
 public:
  // Reads the experiment; prints its notices and the shapes of its sources.
  OpticalRun(const RunOptions& options, const Console& console);

  const Experiment& experiment() const { return experiment_; }
  const TraceableScene& scene() const { return scene_; }
  const Provenance& provenance() const { return provenance_; }
  // Provenance with one warning per failed self-check of this result.
  Provenance provenance(const OpticalResult& result) const;
  // One line per self-check that is off by more than four standard errors: direct light computed in
  // two ways, force and torque computed in two ways, lost power.
  std::vector<std::string> warnings(const OpticalResult& result) const;

  // Adds a warning for all later runs.
  void warn(std::string line) { experiment_.warnings.push_back(std::move(line)); }

  // Adds a receiver that is not in the experiment file, for all later runs; returns its index.
  size_t add_receiver(NamedReceiver receiver);

  // Removes the lamps for which `wanted` is false, for all later runs.
  void keep_beams(const std::function<bool(const Beam&)>& wanted);

  // Traces at an attitude with the options of the experiment or with another number of rays.
  // Doubles the rays until the experiment's target error or time is reached.
  OpticalResult run(const RigidTransform& lab_from_body,
                    const std::function<void(double)>& progress,
                    std::optional<uint64_t> rays = {}) const;

  // Index of the wrench of the whole scene in experiment().receivers and TraceResult::sums.
  size_t wrench_index() const { return wrench_; }
  // Index of the first receiver that is a flux map.
  std::optional<size_t> first_flux_map() const;
  // Index of the flux map called `name`, or of the first one if `name` is empty. Throws InputError
  // with `key` if there is none.
  size_t flux_map_index(const std::string& name, const std::string& key = "array.receiver") const;

  const WrenchReceiver& wrench() const;
  // Force and torque of the light on the whole scene about the centre of rotation, body frame.
  WrenchEstimate wrench_of(const TraceResult& result) const;
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
  std::shared_ptr<const InsideLightReceiver> inside_light_;  // null if no part is closed
  size_t inside_index_ = 0;                                  // index among the receivers
  int threads_ = 0;
  // Gatherer of the wrench of direct light, created on first use; contains null if only rays are
  // possible.
  mutable std::optional<std::shared_ptr<const WrenchGather>> bodies_;
  std::unique_ptr<std::mutex> bodies_mutex_ = std::make_unique<std::mutex>();
};

// A traced attitude of a run with several attitudes.
struct TracedNode {
  const OpticalRun& run;
  size_t nodes;  // total number
  RigidTransform lab_from_body;
  const OpticalResult& light;
  std::optional<Estimate> electric_W = {};  // of the array, if there is one
};
// Called in the order of the nodes.
using NodeWatch = std::function<void(const TracedNode&)>;

// Warnings of several runs, each once: at most three in full, then the number of further ones.
class Warnings {
 public:
  // `where` identifies the run: "tilt 5 deg, heading 0".
  void add(const std::vector<std::string>& warnings, const std::string& where);
  // Print the warnings, and add them to the provenance.
  void print(const Console& console) const;
  Provenance into(Provenance provenance) const;

 private:
  std::vector<std::string> lines() const;

  std::vector<std::string> first_;
  size_t count_ = 0;
};

// Prints the power balance and the effects of the light.
void print_trace(const Console& console, const OpticalRun& run, const OpticalResult& result);

// Adds the items of `more` to `product`.
void append(Product& product, Product more);

}  // namespace photorque
