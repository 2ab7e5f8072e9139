// Publication of results as a whole: files are written to a hidden folder, then moved.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/provenance.h"

namespace photorque {

// Whether files.json lists the file as a result of that command in the folder.
bool is_result_of(const std::filesystem::path& folder, const std::string& command,
                  const std::string& name);

// A hidden folder within the target folder. Its destructor removes it, with all files that were not
// published.
class StagedFiles {
 public:
  // Throws InputError if the folder cannot be created.
  explicit StagedFiles(const std::filesystem::path& folder);
  ~StagedFiles();
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;

  // Folder to write to.
  const std::filesystem::path& path() const { return path_; }

  // Moves all files to the target folder and returns their paths, sorted by name. They become the
  // results of one command and replace those of its last run in this folder. files.json lists the
  // files of each command; listed files that were not written again are deleted. A file that no
  // command lists and that has the name of a result is renamed to NAME~. summary.json (of
  // `diagnose`, diagnosis.json) is removed first and written last: if it exists, all files that it
  // describes belong to one run.
  std::vector<std::filesystem::path> publish_as(const std::string& command,
                                                const Provenance& provenance);

 private:
  std::vector<std::string> names() const;
  void move(const std::string& name) const;

  std::filesystem::path folder_, path_, made_;
  bool published_ = false;
};

}  // namespace photorque
