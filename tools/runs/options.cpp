#include "tools/runs/options.h"

#include "core/files.h"
#include "core/text/format.h"
#include "scenes/experiment/toml.h"

namespace photorque {

std::string RunOptions::experiment_text() const {
  constexpr uint64_t largest_bytes = 1ull << 26;
  return text ? *text : read_file(experiment, largest_bytes);
}

SettingsNode RunOptions::settings(const std::vector<std::string>& changes) const {
  SettingsNode root = parse_toml(experiment_text(), experiment.string());
  for (const std::string& assignment : changes) apply_override(root, assignment);
  return root;
}

std::vector<std::string> RunOptions::all_overrides() const {
  std::vector<std::string> all = overrides;
  if (seed) all.push_back("trace.seed=" + std::to_string(*seed));
  const auto add = [&all](const char* key, double value) {
    all.push_back(printed("%s=%.17g", key, value));
  };
  if (target_error) add("trace.target_error", *target_error);
  if (max_time_s) add("trace.max_time_s", *max_time_s);
  if (allow_outside) all.emplace_back("scene.allow_outside=true");
  return all;
}

}  // namespace photorque
