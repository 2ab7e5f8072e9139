// Assignment of runs to the processes that work on one database.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace photorque {

// Claims on names, as locks on bytes of a file: the system lets go of them when a process ends,
// however it ends. Two names share a byte once in 10^18 pairs; the second then waits. (File systems
// without locks: everybody gets every claim.)
class Claims {
 public:
  // A claim on a run; it ends with the last copy.
  using Claim = std::shared_ptr<const void>;

  // The file is made if absent.
  explicit Claims(const std::filesystem::path& path);
  ~Claims();
  Claims(const Claims&) = delete;
  Claims& operator=(const Claims&) = delete;

  // Claims a run; null if another process has it.
  Claim take(const std::string& name) const;
  // When the others are done with it.
  Claim wait_for(const std::string& name) const;

 private:
  Claim held(int64_t byte) const;

  int descriptor_ = -1;
};

}  // namespace photorque
