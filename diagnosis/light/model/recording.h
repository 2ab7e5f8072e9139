// Recordings of light and power: scans of irradiance, sweeps of current over voltage, runs of an
// array with a tracker. The header of a file determines the kind.
//
// CSV (also .csv.gz) with columns in any order and comments after #. Unreadable rows are omitted
// and counted; outliers are detected later, relative to a model (diagnosis/light/diagnose.h).
// Sweeps may have instrument formats, which photovoltaics/fit/curve_text.h reads; all sweeps are
// reversed and cleaned as that file describes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "attitude/recordings/recording.h"
#include "core/transform.h"

namespace photorque {

struct LightRecording {
  enum class Kind {
    scan,   // u_m, v_m, irradiance_W_m2 [, tilt_deg, heading_deg]
    sweep,  // voltage_V, current_A (or V, I) [, sweep, tilt_deg, heading_deg, cell_temperature_K,
            // irradiance_W_m2]
    run,    // t_s, q_w … q_z, array_voltage_V, array_current_A [, cell_temperature_K, …]
  };
  Kind kind = Kind::scan;
  std::string name;  // path as given

  // One entry per accepted row; quantities that the kind lacks are empty. The irradiance of a sweep
  // is that of a sensor beside the array; NaN where a row has none.
  std::vector<double> u_m, v_m, irradiance_W_m2;
  std::vector<double> voltage_V, current_A;
  std::vector<double> time_s;
  std::vector<Quat> lab_from_body;
  std::vector<double> temperature_K;
  std::vector<int> sweep;
  // For runs with dimmed lamps: lamp current relative to its maximum; the light is assumed to be
  // proportional to it. Empty if it hardly varies.
  std::vector<double> lamp_light;

  // False: all rows have the value of the experiment.
  bool has_attitudes = true, has_temperatures = true;
  int64_t rows_read = 0;     // data rows in the file
  bool is_reversed = false;  // a current was counted into the module; it is positive here
  bool is_stacked = false;   // several curves without numbers stand one below the other
  bool is_density = false;   // its currents are those of 1 cm²
  std::map<std::string, int64_t> rejected;  // by reason: "torn row", "unreadable", …
  std::set<std::string> absent_columns;     // columns that are named but absent
  size_t rows() const { return lab_from_body.size(); }
  // Selects rows.
  LightRecording part(const std::vector<size_t>& rows) const;
};

// The curves of a recording by their number in `sweep`, in order of their first rows. If there are
// several, each name contains the number.
std::vector<LightRecording> sweeps_of(const LightRecording& recording);

// The median of the finite values; NaN where there is none.
double median_of(std::vector<double> values);

// Defaults for rows without these values.
struct DefaultConditions {
  Quat lab_from_body = Quat::Identity();
  double temperature_K = 298.15;
};

// Kind of a file by its header; nothing for unreadable files and other headers.
std::optional<LightRecording::Kind> light_kind_of(const std::filesystem::path& path,
                                                  const RecordingOptions& options = {});

// Whether a file has such a header. False for unreadable files.
bool is_light_recording(const std::filesystem::path& path, const RecordingOptions& options = {});

// One line per file with reversed currents, and per file with curves one below the other.
std::vector<std::string> reading_notes(const std::vector<LightRecording>& recordings);

// Throws InputError with file and line without such a header or a usable row.
LightRecording read_light_recording(const std::filesystem::path& path,
                                    const DefaultConditions& usual,
                                    const RecordingOptions& options = {});

}  // namespace photorque
