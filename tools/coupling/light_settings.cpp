// [light] of an experiment.
#include <cstdlib>

#include "core/constants.h"
#include "tools/coupling/light_model.h"

namespace photorque {
namespace {

namespace light_key {
constexpr ChoiceKey mode("mode",
                         {{"table", "traced once over the attitudes"},
                          {"trace", "traced at every exchange of the run"},
                          {"off", "without light and array"}},
                         0, "method");
constexpr NumberKey tolerance("tolerance", 1e-3, {1e-6, 0.1},
                              "largest error of the table for torque, force, photocurrents and "
                              "light on the cells, each relative to its largest value");
constexpr NumberKey step("step_s", 1.0, {1e-3, 3600.0},
                         "time between exchanges of motion and power");
constexpr IntegerKey rays("rays", 256, int64_t{1} << 40, "number of rays per attitude",
                          {.usually = "`trace.rays`, at most 2^18"});
constexpr IntegerKey max_traces("max_traces", 20000, 100, 10'000'000,
                                "maximum number of traced attitudes of a table");
constexpr NumberKey max_tilt("max_tilt_deg", {0.0, pi, true, false},
                             "tilt of the first table; motion beyond it starts a wider one",
                             {.usually = "twice the initial tilt, at least 5"});
constexpr TextKey cache("cache",
                        "folder of stored tables, relative to the experiment; `\"\"`: none",
                        {.usually = "the user's cache folder"});
constexpr NumberKey time("time_s", {}, "time of switching, in rising order");
constexpr TextKey source("source", "", "name of the source; without it all sources");
constexpr FlagKey on("on", true, "false: the lamps are switched off");
constexpr TablesKey switch_key("switch", "lamps are switched on or off at one time");
constexpr TableKey light("light", "light in a run of the motion");
}  // namespace light_key

// Cache folder of the user (freedesktop.org, XDG Base Directory Specification).
std::optional<std::filesystem::path> user_cache() {
  const char* own = std::getenv("XDG_CACHE_HOME");
  if (own != nullptr && *own != '\0') return std::filesystem::path(own) / "photorque";
  const char* home = std::getenv("HOME");
  if (home == nullptr || *home == '\0') return {};
  return std::filesystem::path(home) / ".cache" / "photorque";
}

std::vector<LightSettings::Switch> read_switches(const Settings& light) {
  std::vector<LightSettings::Switch> switches;
  for (const Settings& s : light.get(light_key::switch_key)) {
    switches.push_back({s.get(light_key::time), s.get(light_key::source), s.get(light_key::on)});
    if (switches.size() > 1 && switches.back().time_s < switches[switches.size() - 2].time_s) {
      throw s.error(light_key::time, std::to_string(switches.back().time_s),
                    "switches in order of time");
    }
  }
  return switches;
}

}  // namespace

LightSettings read_light(const ExperimentFile& file) {
  LightSettings light;
  constexpr uint64_t usual_rays = 1 << 18;
  light.rays = std::min<uint64_t>(file.trace.rays, usual_rays);
  light.cache = user_cache();
  const auto tables = file.others("light");
  if (tables.empty()) return light;
  const Settings& s = tables[0];
  light.mode = static_cast<LightSettings::Mode>(s.get(light_key::mode));
  light.tolerance = s.get(light_key::tolerance);
  light.step_s = s.get(light_key::step);
  light.rays = static_cast<uint64_t>(s.get_or(light_key::rays, static_cast<int64_t>(light.rays)));
  light.max_traces = static_cast<size_t>(s.get(light_key::max_traces));
  if (s.has(light_key::max_tilt)) light.max_tilt_rad = s.get(light_key::max_tilt);
  if (s.has(light_key::cache)) {
    const std::string folder = s.get(light_key::cache);
    light.cache.reset();
    if (!folder.empty()) light.cache = file.path.parent_path() / folder;
  }
  light.switches = read_switches(s);
  s.finish();
  return light;
}

Key light_table() {
  using namespace light_key;
  return light.of({mode, tolerance, step, rays, max_traces, max_tilt, cache,
                   switch_key.of({time, source, on})});
}

}  // namespace photorque
