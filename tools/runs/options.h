// Options of a run, from the command line or from Python.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "raytrace/emitter.h"

namespace photorque {

// A lamp that is not in the experiment file, and the hash of its light for the provenance.
struct FurtherLamp {
  Beam beam;
  std::string hash;
};

struct RunOptions {
  // The experiment's file. If `text` is set, it need not exist; then it is the name in messages,
  // and files that the text names are relative to its folder.
  std::filesystem::path experiment;
  std::optional<std::string> text;      // TOML in place of the file's text
  std::vector<std::string> overrides;   // KEY=VALUE, in order
  int threads = 0;                      // 0: all
  std::optional<uint64_t> seed;         // replaces the experiment's seed
  std::optional<double> target_error;   // replaces [trace] target_error
  std::optional<double> max_time_s;     // replaces [trace] max_time_s
  bool allow_outside = false;           // replaces [scene] allow_outside
  std::optional<double> max_memory_GB;  // memory limit of the run; empty: free memory
  std::vector<FurtherLamp> lamps = {};  // in addition to those of the experiment

  // `text`, or the text of the file.
  std::string experiment_text() const;
  // The text as settings with these changes. Throws InputError for invalid TOML or changes.
  SettingsNode settings(const std::vector<std::string>& changes) const;
  // The overrides, including those from seed, target error and time.
  std::vector<std::string> all_overrides() const;
};

}  // namespace photorque
