// Recordings of light and power: scans of irradiance, sweeps of current over voltage, runs of an
// array under a tracker. The header of a file determines which of the three it is.
//
// CSV (also .csv.gz), columns in any order, comments from # on. Rows that cannot be read are left
// out and counted; wild readings are found later, against a model (diagnosis/light/diagnose.h).
// Sweeps may be written as instruments do, which photovoltaics/fit/curve_text.h reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

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

  // One entry per row that was kept; quantities that the kind lacks are empty. The irradiance of a
  // sweep is what a sensor beside the array saw; NaN where a row has none.
  std::vector<double> u_m, v_m, irradiance_W_m2;
  std::vector<double> voltage_V, current_A;
  std::vector<double> time_s;
  std::vector<Quat> lab_from_body;
  std::vector<double> temperature_K;
  std::vector<int> sweep;
  // Of runs with dimmed lamps: their current over its largest, to which their light is taken to
  // be proportional. Empty where it hardly changes.
  std::vector<double> lamp_light;

  // False: each row has the value of the experiment.
  bool has_attitudes = true, has_temperatures = true;
  int64_t rows_read = 0;                    // data rows in the file
  std::map<std::string, int64_t> rejected;  // by reason: "torn row", "unreadable", …
  std::set<std::string> absent_columns;     // that were named and the file has not
  size_t rows() const { return lab_from_body.size(); }
  // The chosen rows alone.
  LightRecording part(const std::vector<size_t>& rows) const;
};

// The curves of a recording, by their number in `sweep`, in the order in which they begin; where
// there are several, each name says which it is.
std::vector<LightRecording> sweeps_of(const LightRecording& recording);

// The median of the finite values; NaN where there is none.
double median_of(std::vector<double> values);

// Defaults for rows without these values.
struct UsualCircumstances {
  Quat lab_from_body = Quat::Identity();
  double temperature_K = 298.15;
};

// Names of columns in the file by those above, as [recording] columns states them.
using LightColumns = std::map<std::string, std::string>;

// By a file's header; nothing for files that cannot be read, or have another.
std::optional<LightRecording::Kind> light_kind_of(const std::filesystem::path& path,
                                                  const LightColumns& columns = {});

// Whether a file's header is one of these. False for files that cannot be read.
bool is_light_recording(const std::filesystem::path& path, const LightColumns& columns = {});

// InputError with file and line when there is no such header or no usable row.
LightRecording read_light_recording(const std::filesystem::path& path,
                                    const UsualCircumstances& usual,
                                    const LightColumns& columns = {});

}  // namespace photorque
