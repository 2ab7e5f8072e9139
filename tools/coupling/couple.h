// Runs with coupled light, power and motion, and their checkpoint file.
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

// Checkpoint of a long run, so that it can be interrupted and resumed.

// One line of text each for: format, range of the table of light, hash of the range and of all
// inputs of the run, hash of the state; then the state. Each write replaces the file completely or
// not at all.
class CheckpointFile {
 public:
  CheckpointFile(std::filesystem::path path, double every_s);

  struct Kept {
    double table_tilt_rad = 0.0;  // range of the table of light; 0 without a table
    std::string state;
  };
  // The stored state of the run with this `identity`, program and inputs; empty if there is no
  // file. Throws InputError for the state of another run and for a damaged file.
  std::optional<Kept> read(const std::string& identity);

  // Whether the time between two states has passed.
  bool due() const { return std::chrono::steady_clock::now() >= next_; }
  // Throws InputError if the file cannot be written; the previous file remains.
  void write(const std::string& identity, double table_tilt_rad, const std::string& state);

  const std::filesystem::path& path() const { return path_; }
  // Removes the file, which is not needed after the run; never throws.
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
  PropagationResult motion;  // its events include those of lamps, light and battery
  // Null if the file has no light or if [light] mode is "off".
  std::unique_ptr<LightModel> light;
  std::shared_ptr<const RotationTable> table;  // null if light is traced during the run
  std::unique_ptr<CoupledRun> beside;          // null if the only effect of light is a torque
  // Upper bound of the attitude error at the end due to the error of the table, for runs up to an
  // hour.
  std::optional<double> attitude_error_rad;
  std::vector<std::string> warnings;  // quantities whose error in the table exceeds light.tolerance
};

// Throws InputError if light or power is stated both by the scene and as a disturbance.
void require_light_once(const ExperimentFile& file);

// Names and hashes of inputs, line by line: part of the identity of a run.
std::string of_inputs(const std::vector<std::pair<std::string, std::string>>& inputs);

// Propagates in the light of the experiment. The first table of light covers twice the initial tilt
// (at least 5 deg). A run that exceeds its range restarts with a range twice as large, up to the
// platform's stop. Throws InputError for a disturbance that would count light or power twice.
// With a checkpoint file the run continues from the stored state and stores its own state there.
// `identity` contains all inputs of the run except the light.
CoupledResult propagate_in_light(const RunOptions& options, const Console& console,
                                 const ExperimentFile& file, const PropagationRun& run,
                                 CheckpointFile* checkpoint = nullptr,
                                 const std::string& identity = {});

}  // namespace photorque
