// Results that appear together: written aside, then moved to where they belong.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/provenance.h"

namespace photorque {

// Whether files.json lists it among the files of that command in the folder.
bool is_result_of(const std::filesystem::path& folder, const std::string& command,
                  const std::string& name);

// A hidden folder within the one where files belong. What it made goes away with it unless the
// files were published.
class StagedFiles {
 public:
  // InputError when the folder cannot be made.
  explicit StagedFiles(const std::filesystem::path& folder);
  ~StagedFiles();
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;

  // Where to write.
  const std::filesystem::path& path() const { return path_; }

  // Moves all files to where they belong and returns their paths, in the order of their names. They
  // are the results of one command, and replace those of its last run in this folder:
  // files.json lists the files of a command, and files of the list that were not written again go
  // away. What no command lists and has the name of a result is kept beside it as NAME~.
  // summary.json (of `diagnose`, diagnosis.json) goes first and comes last: where it exists, all
  // files that it describes belong to one run.
  std::vector<std::filesystem::path> publish_as(const std::string& command,
                                                const Provenance& provenance);

 private:
  std::vector<std::string> names() const;
  void move(const std::string& name) const;

  std::filesystem::path folder_, path_, made_;
  bool published_ = false;
};

}  // namespace photorque
