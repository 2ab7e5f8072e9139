// Options of a run: the program's command line or a caller from Python.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "raytrace/emitter.h"

namespace photorque {

// A lamp that no experiment file describes, and the hash of its light for the provenance.
struct FurtherLamp {
  Beam beam;
  std::string hash;
};

struct RunOptions {
  // The experiment's file. With a given text it need not exist: it is what messages call the text,
  // and files that the text names are relative to its folder.
  std::filesystem::path experiment;
  std::optional<std::string> text;      // TOML in place of the file's text
  std::vector<std::string> overrides;   // KEY=VALUE, in order
  int threads = 0;                      // 0: all
  std::optional<uint64_t> seed;         // over the experiment's own
  std::optional<double> target_error;   // over [trace] target_error
  std::optional<double> max_time_s;     // over [trace] max_time_s
  bool allow_outside = false;           // over [scene] allow_outside
  std::optional<double> max_memory_GB;  // limit of the run; nothing: free memory
  std::vector<FurtherLamp> lamps = {};  // that shine besides those of the experiment

  // The text, or that of the file.
  std::string experiment_text() const;
  // The overrides with seed, target and time of the trace among them.
  std::vector<std::string> all_overrides() const;
};

}  // namespace photorque
