// Assignment of runs to the processes that work on one database.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace photorque {

// Claims on names, as locks on bytes of a file. The system releases them when a process ends for
// any reason. Two names share a byte once in 10^18 pairs; the second then waits. (On file systems
// without locks all claims succeed.)
class Claims {
 public:
  // A claim on a run; released by its last copy.
  using Claim = std::shared_ptr<const void>;

  // Creates the file if it is missing.
  explicit Claims(const std::filesystem::path& path);
  ~Claims();
  Claims(const Claims&) = delete;
  Claims& operator=(const Claims&) = delete;

  // Claims a run; null if another process has it.
  Claim take(const std::string& name) const;
  // Waits until other processes have released the name.
  Claim wait_for(const std::string& name) const;

 private:
  Claim held(int64_t byte) const;

  int descriptor_ = -1;
};

}  // namespace photorque
