// The inputs of a run as one hash.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "tools/runs/options.h"
#include "tools/sweeps/outcome.h"

namespace photorque {

// The experiment of a sweep under the changes of its runs.
class RunIdentity {
 public:
  RunIdentity(RunOptions options, std::string command);

  // The hash over program, command, every key under these changes but those of [sweep], and the
  // content of every file that a text names: scene with its buffers and pictures, lamps, tables.
  // Comments, order and the way numbers are written do not count. InputError for a change that
  // makes no sense.
  std::string of(const Changes& changes);

  // The value of a key under these changes. InputError where there is none.
  SettingsNode value(const Changes& changes, const std::string& key) const;

  // The experiment under these changes, without its plan, as a file for `folder`: files are named
  // from there. `head` are comment lines at its beginning.
  std::string experiment(const Changes& changes, const std::vector<std::string>& head,
                         const std::filesystem::path& folder) const;

 private:
  SettingsNode changed(const Changes& changes) const;
  std::string content_of_file(const std::filesystem::path& path);

  RunOptions options_;
  std::string command_, program_;
  SettingsNode root_;
  std::filesystem::path folder_;
  std::map<std::string, std::string> files_;  // path, size and time of change: hash
};

}  // namespace photorque
