// Results of `power` beyond the maximum power point: losses, trackers, a day, a target, wiring.
#pragma once

#include <optional>

#include "photovoltaics/array/day.h"
#include "photovoltaics/array/layout.h"
#include "photovoltaics/array/losses.h"
#include "photovoltaics/array/tracker.h"
#include "tools/runs/optical_run.h"
#include "tools/runs/published.h"

namespace photorque {

struct ArrayPower;

// [array.target] at zero tilt. Missing keys are taken from "array_power_W" and "array_efficiency"
// in the experiment's [[published]] at zero tilt.
struct ArrayTarget {
  double power_W = 0.0;
  double efficiency = 0.0;  // of the light on the cells
};

// Sub-tables of `[array]`; each is optional.
struct ArrayReport {
  // [array.chain]: wall_plug_efficiency, collimator_efficiency, converter_efficiency.
  struct Chain {
    std::optional<double> wall_plug, collimator, converter;
  } chain;
  std::optional<ArrayTarget> target;  // [array.target]
  // [array.tracker]: trackers (see read_trackers()) and the motion during which they run. The scene
  // is traced at each instant.
  struct Motion {
    std::vector<double> time_s, tilt_rad, heading_rad;
    std::vector<Tracker> trackers;
  };
  std::optional<Motion> motion;
  std::optional<DaySettings> day;  // [array.day], see read_day()
  // [array.layout]: max_tried = 2000. For the attitudes of the motion, or the traced one.
  std::optional<int64_t> layout_most_tried;
  std::vector<PublishedFigure> published;  // [[published]], compared with the target
};

// Reads the sub-tables of `[array]`. Throws InputError for invalid keys.
ArrayReport read_array_report(const Settings& array, std::vector<PublishedFigure> published);
// Key [array] including the keys of its design.
Key array_table();

// Traces, computes and prints all requested results; losses are always included.
Product report_array(const Console& console, const OpticalRun& run, const ArrayPower& array,
                     const TraceResult& traced, const ArrayResult& result);

}  // namespace photorque
