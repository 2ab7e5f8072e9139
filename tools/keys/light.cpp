// [array], [light] and [[published]].
#include "core/constants.h"
#include "photovoltaics/array/keys.h"
#include "tools/keys/tables.h"

namespace photorque {
namespace {

constexpr Range stage_range{0.0, 1.0, true, false};

Key chain_table() {
  const auto stage = [](const char* name, const char* what) {
    return Key::number(name, stage_range, what).usually_is("left out");
  };
  return Key::table("chain",
                    {stage("wall_plug_efficiency", "light over mains"),
                     stage("collimator_efficiency", "of the lamps' optics"),
                     stage("converter_efficiency", "after the array")},
                    "stages before and after the array in the list of losses");
}

Key target_table() {
  return Key::table(
      "target",
      {Key::number("power_W", Range::positive(), "what the array is to give")
           .usually_is("`array_power_W` of `[[published]]` at zero tilt"),
       Key::number("efficiency", stage_range, "of light on the cells")
           .usually_is("`array_efficiency` of `[[published]]`")},
      "what these require: EQE · V_oc · FF, light on the cells, what each known cell reaches, how "
      "the "
      "power changes with light, temperature, resistances; and what the published powers at other "
      "tilts need beyond the cosine");
}

std::vector<Key> motion_keys() {
  return {Key::numbers("time_s", {}, "instants, rising, at least two")
              .usually_is("none: for `propagate`"),
          Key::numbers("tilt_deg", {-pi, pi}, "with `time_s`: one per instant").optional(),
          Key::numbers("heading_deg", {-2.0 * pi, 2.0 * pi}, "one per instant").usually_is("0")};
}

}  // namespace

Key array_table() {
  return Key::table(
      "array",
      joined(
          {{Key::text("receiver", "the map whose light the cells take")
                .usually_is("the first `flux_map`")},
           array_design_keys(),
           {chain_table(), target_table(),
            Key::table("tracker", joined({motion_keys(), tracker_keys()}),
                       "four trackers on the exact curves while the platform moves through these "
                       "instants"),
            Key::table("day", day_keys(),
                       "array and battery over time; with the first tracker's efficiency if there "
                       "is an `[array.tracker]`"),
            Key::table("layout",
                       {Key::integer_or("most_tried", 2000, 1, 10000000,
                                        "assignments of cells to strings: every one if there are "
                                        "few, else exchanges of pairs")},
                       "a better wiring for the attitudes of the motion, with the bound that none "
                       "exceeds. Not with `cross_tied`")}}),
      "cells and wiring on a flux map");
}

Key published_table() {
  return Key::tables(
      "published",
      {Key::text("quantity", "a name in `summary.json`"), Key::number("value", {}, "in its unit"),
       Key::number_or("tilt_deg", 0.0, {0.0, pi}, "at which it holds"),
       Key::number("rounded_to", Range::positive(),
                   "one unit of its last printed digit (38 %: 0.01): ours is held against it, and "
                   "`published_misfit` of the summary is the sum of ((ours − `value`)/(½ "
                   "`rounded_to`))²: for `optimise`, at most 1 for each figure that agrees")
           .optional(),
       Key::text("source", "who printed it"), Key::text_or("why", "", "ours differs")},
      "a figure that somebody printed, compared at the same tilt");
}

Key light_table() {
  return Key::table(
      "light",
      {Key::choice_or("mode",
                      {{"table", "traced once over the attitudes"},
                       {"trace", "traced at every exchange of the run"},
                       {"off", "light and array left out"}},
                      0, "how light enters the run"),
       Key::number_or("tolerance", 1e-3, {1e-6, 0.1},
                      "error of the table, of torque, force, photocurrents and light on the cells, "
                      "each relative to its largest"),
       Key::number_or("step_s", 1.0, {1e-3, 3600.0}, "between exchanges of motion and power"),
       Key::integer("rays", 256, int64_t{1} << 40, "per attitude")
           .usually_is("`trace.rays`, at most 2^18"),
       Key::integer_or("max_traces", 20000, 100, 10'000'000,
                       "attitudes of a table, after which it is refined no further"),
       Key::number("max_tilt_deg", {0.0, pi, true, false}, "the widest table")
           .usually_is("the platform's stop, or 180"),
       Key::text("cache", "where tables are kept, relative to the experiment; `\"\"`: nowhere")
           .usually_is("the user's cache folder"),
       Key::tables(
           "switch",
           {Key::number("time_s", {}, "in order"), Key::text_or("source", "", "by name; none: all"),
            Key::flag_or("on", true, "false: off")},
           "lamps are switched")},
      "light in a run of the motion");
}

}  // namespace photorque
