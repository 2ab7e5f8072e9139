// A hash of all inputs of a run.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "tools/runs/options.h"
#include "tools/sweeps/outcome.h"

namespace photorque {

// The experiment of a sweep with the changes of its runs.
class RunIdentity {
 public:
  RunIdentity(RunOptions options, std::string command);

  // Hash of the program, the command, every key with these changes (except [sweep]), and the
  // content of every file that a text names: scene with buffers and pictures, lamps, tables.
  // Comments, order and the notation of numbers have no influence. Throws InputError for an invalid
  // change.
  std::string of(const Changes& changes);

  // Value of a key with these changes. Throws InputError if there is none.
  SettingsNode value(const Changes& changes, const std::string& key) const;

  // Text of the experiment with these changes, without its plan, for a file in `folder`: file names
  // are relative to it. `head` are comment lines at its beginning.
  std::string experiment(const Changes& changes, const std::vector<std::string>& head,
                         const std::filesystem::path& folder) const;

 private:
  SettingsNode changed(const Changes& changes) const;
  std::string content_of_file(const std::filesystem::path& path);

  RunOptions options_;
  std::string command_, program_;
  SettingsNode root_;
  std::filesystem::path folder_;
  std::map<std::string, std::string> files_;  // hash by path, size and time of change
};

}  // namespace photorque
