// Common functions of the attitude commands: the checked experiment and its provenance.
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

// An experiment file with its overrides. An orbit without `sun_direction` gets that of the sun of
// [[source]], and `planet_light` that of the orbit. Throws InputError for tables that no command
// reads; tables of optical commands are ignored.
class AttitudeExperiment {
 public:
  explicit AttitudeExperiment(const RunOptions& options);

  const Settings& settings() const { return file_.settings; }
  const ExperimentFile& file() const { return file_; }
  // Names and hashes of the experiment, the overrides and every file that the experiment names.
  Provenance provenance(uint64_t seed) const;
  // Adds another input, such as a recording.
  void add_input(const std::filesystem::path& path);

 private:
  ExperimentFile file_;
};

// If the experiment has a scene and a camera with geometry, markers can be hidden by the scene:
// sets TrackingCamera::is_hidden to shadow rays. Returns names and hashes of the files read.
std::vector<std::pair<std::string, std::string>> look_through_scene(const ExperimentFile& file,
                                                                    Sensors& sensors);

// Columns of a printed table. Numbers have three digits.
struct PrintedColumn {
  std::string title;
  std::string name;  // of the table's column; the column is omitted if it does not exist
};
// Prints at most `most_rows` rows without --verbose.
void print_table(const Console& console, const Table& table,
                 const std::vector<PrintedColumn>& columns, size_t most_rows = 1000000);

// Prints the columns "quantity" and "why" of a table of published figures.
void print_reasons(const Console& console, const Table& figures);

}  // namespace photorque
