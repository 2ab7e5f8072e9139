// Runs in which light, power and motion act on each other, and the file that keeps their state.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/coupling/coupled_run.h"
#include "tools/runs/console.h"

namespace photorque {

// The file that a run which takes long keeps its state in, so that it can be broken off.

// A line of text for each of: format, width of the table of light, hash of that and of all that the
// run follows from, hash of the state; then the state. Written whole or not at all, over the last
// one.
class CheckpointFile {
 public:
  CheckpointFile(std::filesystem::path path, double every_s);

  struct Kept {
    double table_tilt_rad = 0.0;  // how far the table of light reached; 0 without one
    std::string state;
  };
  // The stored state of the run with this `identity`, program and inputs; nothing where there is no
  // file. InputError for the state of another run and for a file that is damaged.
  std::optional<Kept> read(const std::string& identity);

  // Whether the time between two states has passed.
  bool due() const { return std::chrono::steady_clock::now() >= next_; }
  // InputError when it cannot be written; the previous file stays.
  void write(const std::string& identity, double table_tilt_rad, const std::string& state);

  const std::filesystem::path& path() const { return path_; }
  // Once the results are complete it is not needed; never throws.
  void remove() const {
    std::error_code stays;
    std::filesystem::remove(path_, stays);
  }

 private:
  void wait();

  std::filesystem::path path_;
  std::chrono::steady_clock::duration every_;
  std::chrono::steady_clock::time_point next_;
};

// A run and its coupled simulations.
struct CoupledResult {
  PropagationResult motion;  // with the events of lamps, light and battery among its own
  // Null where the file has no light or [light] mode is "off".
  std::unique_ptr<LightModel> light;
  std::shared_ptr<const RotationTable> table;  // null where light was traced in the run
  std::unique_ptr<CoupledRun> beside;          // null where light is a torque alone
  // Upper limit for the rotation at the end by the error of the table, for runs up to an hour.
  std::optional<double> attitude_error_rad;
  std::vector<std::string> warnings;  // where the table is further off than light.tolerance
};

// InputError for light or power that an experiment states twice: as a disturbance beside a scene.
void require_light_once(const ExperimentFile& file);

// Names and hashes of inputs, line by line: part of the identity of a run.
std::string of_inputs(const std::vector<std::pair<std::string, std::string>>& inputs);

// Propagates in the light of the experiment. A table of light first holds twice the initial tilt
// (at least 5 deg); a run that goes beyond begins again with one twice as wide, up to the
// platform's stop. InputError for a disturbance that would count light or power twice.
// With a checkpoint file the run goes on from the state that it holds and keeps its own there;
// `identity` is all that the run follows from, but for the light.
CoupledResult propagate_in_light(const RunOptions& options, const Console& console,
                                 const ExperimentFile& file, const PropagationRun& run,
                                 CheckpointFile* checkpoint = nullptr,
                                 const std::string& identity = {});

}  // namespace photorque
