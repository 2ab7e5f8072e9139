#include "tools/coupling/settings.h"

#include <algorithm>
#include <cstdlib>

#include "core/constants.h"

namespace photorque {
namespace {

// Where programs keep what they can make again (freedesktop.org, XDG Base Directory Specification).
std::optional<std::filesystem::path> user_cache() {
  const char* own = std::getenv("XDG_CACHE_HOME");
  if (own != nullptr && *own != '\0') return std::filesystem::path(own) / "photorque";
  const char* home = std::getenv("HOME");
  if (home == nullptr || *home == '\0') return {};
  return std::filesystem::path(home) / ".cache" / "photorque";
}

std::vector<LightSettings::Switch> read_switches(const Settings& light) {
  std::vector<LightSettings::Switch> switches;
  for (const Settings& s : light.tables("switch")) {
    switches.push_back({s.number("time_s"), s.text_or("source", ""), s.flag_or("on", true)});
    if (switches.size() > 1 && switches.back().time_s < switches[switches.size() - 2].time_s) {
      throw s.error("time_s", std::to_string(switches.back().time_s), "switches in order of time");
    }
  }
  return switches;
}

}  // namespace

bool has_light(const ExperimentFile& file) {
  return file.scene_file && !file.sources.empty() && file.settings.has("platform");
}

LightSettings read_light(const ExperimentFile& file) {
  LightSettings light;
  constexpr uint64_t usual_rays = 1 << 18;
  light.rays = std::min<uint64_t>(file.trace.rays, usual_rays);
  light.cache = user_cache();
  const auto tables = file.others("light");
  if (tables.empty()) return light;
  const Settings& s = tables[0];
  light.mode = static_cast<LightSettings::Mode>(s.choice_or("mode", {"table", "trace", "off"}, 0));
  light.tolerance = s.number_or("tolerance", light.tolerance, {1e-6, 0.1});
  light.step_s = s.number_or("step_s", light.step_s, {1e-3, 3600.0});
  light.rays = static_cast<uint64_t>(
      s.integer_or("rays", static_cast<int64_t>(light.rays), 256, int64_t{1} << 40));
  light.max_traces = static_cast<size_t>(s.integer_or("max_traces", 20000, 100, 10'000'000));
  if (s.has("max_tilt_deg")) light.max_tilt_rad = s.number("max_tilt_deg", {0.0, pi, true, false});
  if (s.has("cache")) {
    const std::string folder = s.text("cache");
    light.cache.reset();
    if (!folder.empty()) light.cache = file.path.parent_path() / folder;
  }
  light.switches = read_switches(s);
  s.finish();
  return light;
}

}  // namespace photorque
