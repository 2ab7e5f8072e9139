// The folder that a command writes into: made, tried, locked and cleaned before the work.
#pragma once

#include <filesystem>

namespace photorque {

// A folder in which one run works. What killed runs left in it is removed. When it ends, folders
// that it made and that are still empty go away.
class OutputFolder {
 public:
  // What to do about others that work in the folder: refuse to; let those in that share as well;
  // wait until they are done.
  enum class Others { refuse, share, wait };

  // InputError when `path` is no folder or cannot be one, when a file in it cannot be written, or
  // when another run works there. (File systems without locks: nobody is kept out.)
  OutputFolder(const std::filesystem::path& path, Others others);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

 private:
  void make();
  void try_to_write() const;
  bool lock(Others others);
  void remove_empty() const;

  std::filesystem::path path_, made_;  // absolute; the outermost folder that was not there
  int descriptor_ = -1;
};

}  // namespace photorque
