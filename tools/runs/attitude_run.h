// Shared by the attitude commands: the experiment, checked, and where it came from.
#pragma once

#include <string>
#include <vector>

#include "attitude/recordings/sensors.h"
#include "core/product.h"
#include "core/provenance.h"
#include "scenes/experiment/experiment.h"
#include "tools/runs/console.h"
#include "tools/runs/options.h"

namespace photorque {

// An experiment file with its overrides; an orbit without `sun_direction` has that of the sun of
// [[source]], and `planet_light` that of the orbit. InputError for tables that no command reads;
// those of optical commands are left alone.
class AttitudeExperiment {
 public:
  explicit AttitudeExperiment(const RunOptions& options);

  const Settings& settings() const { return file_.settings; }
  const ExperimentFile& file() const { return file_; }
  // Names and hashes of the experiment, the overrides and every file that the experiment names.
  Provenance provenance(uint64_t seed) const;
  // Another input, such as a recording.
  void add_input(const std::filesystem::path& path);

 private:
  ExperimentFile file_;
};

// Where the experiment has a scene and a camera with geometry, lets the camera look through that
// scene: TrackingCamera::is_hidden by shadow rays. Returns names and hashes of the files read.
std::vector<std::pair<std::string, std::string>> look_through_scene(const ExperimentFile& file,
                                                                    Sensors& sensors);

// Columns of a printed table. Numbers have three digits.
struct PrintedColumn {
  std::string title;
  std::string name;  // of the table's column; left out where there is none
};
// At most so many rows without --verbose.
void print_table(const Console& console, const Table& table,
                 const std::vector<PrintedColumn>& columns, size_t most_rows = 1000000);

// The columns "quantity" and "why" of a table of published figures.
void print_reasons(const Console& console, const Table& figures);

}  // namespace photorque
