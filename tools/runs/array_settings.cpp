// [array]: tables of the additional results of `power`.
#include <algorithm>

#include "core/constants.h"
#include "photovoltaics/array/keys.h"
#include "tools/runs/array_report.h"

namespace photorque {
namespace {

constexpr Range efficiency{1e-6, 1.0};

namespace chain_key {
constexpr NumberKey wall_plug("wall_plug_efficiency", efficiency,
                              "radiant power of the lamps divided by the mains power",
                              {.usually = "left out"});
constexpr NumberKey collimator("collimator_efficiency", efficiency,
                               "efficiency of the optics of the lamps", {.usually = "left out"});
constexpr NumberKey converter("converter_efficiency", efficiency,
                              "efficiency of the converter after the array",
                              {.usually = "left out"});
}  // namespace chain_key

namespace target_key {
constexpr NumberKey power("power_W", Range::positive(), "required power of the array",
                          {.usually = "`array_power_W` of `[[published]]` at zero tilt"});
constexpr NumberKey cell_efficiency("efficiency", efficiency,
                                    "required efficiency from light on the cells to power",
                                    {.usually = "`array_efficiency` of `[[published]]`"});
}  // namespace target_key

namespace motion_key {
constexpr NumbersKey time("time_s", {}, "times of the attitudes, at least two, in rising order",
                          {.usually = "none: for `propagate`"});
constexpr NumbersKey tilt("tilt_deg", {-pi, pi}, "tilt at each time of `time_s`",
                          {.optional = true});
constexpr NumbersKey heading("heading_deg", {-2.0 * pi, 2.0 * pi},
                             "heading at each time of `time_s`", {.usually = "0"});
}  // namespace motion_key

namespace report_key {
constexpr TextKey receiver("receiver", "irradiance map with the light on the cells",
                           {.usually = "the first `flux_map`"});
constexpr TableKey chain_table("chain",
                               "efficiencies before and after the array, for the list of losses");
constexpr TableKey target(
    "target",
    "requirements of a power and an efficiency: EQE · V_oc · FF and light on the cells. Also the "
    "efficiency of each known cell, the sensitivity of the power to light, temperature and "
    "resistances, and the factor beyond the cosine in published powers at other tilts");
constexpr TableKey tracker(
    "tracker",
    "four maximum power point trackers on the exact curves, while the attitude changes over time");
constexpr TableKey day("day",
                       "array and battery over time; with the efficiency of the first tracker if "
                       "there is an `[array.tracker]`");
constexpr IntegerKey most_tried(
    "most_tried", 2000, 1, 10000000,
    "number of assignments of cells to strings: all if there are few, else exchanges of pairs");
constexpr TableKey layout(
    "layout",
    "search for a better wiring over the attitudes of the motion, and an upper "
    "bound of the power of all wirings. Not with `cross_tied`");
constexpr TableKey array("array", "cells and wiring on a flux map");
}  // namespace report_key

std::optional<double> published_upright(const std::vector<PublishedFigure>& figures,
                                        const std::string& quantity) {
  for (const PublishedFigure& figure : figures) {
    if (figure.quantity == quantity && figure.tilt_rad < same_tilt_rad) return figure.value;
  }
  return std::nullopt;
}

double given_or_published(const Settings& target, const NumberKey& key,
                          const std::optional<double>& published) {
  return published ? target.get_or(key, *published) : target.get(key);
}

ArrayTarget read_array_target(const Settings& target,
                              const std::vector<PublishedFigure>& published) {
  return {
      given_or_published(target, target_key::power, published_upright(published, "array_power_W")),
      given_or_published(target, target_key::cell_efficiency,
                         published_upright(published, "array_efficiency"))};
}

std::optional<double> stage_of(const Settings& chain, const NumberKey& key) {
  if (!chain.has(key)) return {};
  return chain.get(key);
}

ArrayReport::Motion read_motion(const Settings& s) {
  using namespace motion_key;
  ArrayReport::Motion motion;
  motion.trackers = read_trackers(s);
  // Without instants, the tracker is meant for `propagate`, in which the platform moves.
  if (!s.has(motion_key::time) && !s.has(tilt)) return motion;
  motion.time_s = s.get(motion_key::time);
  motion.tilt_rad = s.get(tilt);
  motion.heading_rad =
      s.has(heading) ? s.get(heading) : std::vector<double>(motion.time_s.size(), 0.0);
  const bool rises =
      std::ranges::adjacent_find(motion.time_s, std::greater_equal<>()) == motion.time_s.end();
  if (motion.time_s.size() < 2 || !rises) {
    throw s.error(motion_key::time, std::to_string(motion.time_s.size()) + " instants",
                  "at least two, ascending");
  }
  if (motion.tilt_rad.size() != motion.time_s.size() ||
      motion.heading_rad.size() != motion.time_s.size()) {
    throw s.error(tilt, std::to_string(motion.tilt_rad.size()) + " angles",
                  std::to_string(motion.time_s.size()) + ", one per instant");
  }
  return motion;
}

}  // namespace

ArrayReport read_array_report(const Settings& array, std::vector<PublishedFigure> published) {
  using namespace report_key;
  ArrayReport report;
  report.published = std::move(published);
  if (array.has(chain_table)) {
    const Settings stages = array.get(chain_table);
    report.chain = {stage_of(stages, chain_key::wall_plug), stage_of(stages, chain_key::collimator),
                    stage_of(stages, chain_key::converter)};
  }
  if (array.has(target)) report.target = read_array_target(array.get(target), report.published);
  if (array.has(tracker)) report.motion = read_motion(array.get(tracker));
  if (array.has(day)) report.day = read_day(array.get(day));
  if (array.has(layout)) report.layout_most_tried = array.get(layout).get(most_tried);
  return report;
}

Key array_table() {
  using namespace report_key;
  const std::vector<Key> motion = {motion_key::time, motion_key::tilt, motion_key::heading};
  return report_key::array.of(
      joined({{receiver},
              array_design_keys(),
              {chain_table.of({chain_key::wall_plug, chain_key::collimator, chain_key::converter}),
               target.of({target_key::power, target_key::cell_efficiency}),
               tracker.of(joined({motion, tracker_keys()})), day.of(day_keys()),
               layout.of({most_tried})}}));
}

}  // namespace photorque
