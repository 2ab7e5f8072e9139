// Results of `power` beyond the maximum power point: losses, trackers, a day, a target, a wiring.
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

// [array.target], at zero tilt. A key that is left out is the figure "array_power_W" or
// "array_efficiency" of the experiment's [[published]] at zero tilt.
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
  // [array.tracker]: see read_trackers(); and the motion during which they run, instant by instant.
  // The scene is traced at each.
  struct Motion {
    std::vector<double> time_s, tilt_rad, heading_rad;
    std::vector<Tracker> trackers;
  };
  std::optional<Motion> motion;
  std::optional<DaySettings> day;  // [array.day], see read_day()
  // [array.layout]: max_tried = 2000. Over the attitudes of the motion, or the one that is traced.
  std::optional<int64_t> layout_most_tried;
  std::vector<PublishedFigure> published;  // [[published]], compared with the target
};

ArrayReport read_array_report(const Settings& array, std::vector<PublishedFigure> published);
// [array] with the keys of its design.
Key array_table();

// Traces, computes and prints all that was asked for; the losses always.
Product report_array(const Console& console, const OpticalRun& run, const ArrayPower& array,
                     const TraceResult& traced, const ArrayResult& result);

}  // namespace photorque
