// Output folder of a command: created, tested, locked and cleaned before the work; left clean if a
// signal ends the program.
#pragma once

#include <atomic>
#include <csignal>
#include <filesystem>
#include <mutex>
#include <thread>
#include <vector>

namespace photorque {

// A folder in which one run works. Temporary files of killed runs in it are removed. The destructor
// removes folders that it created and that are still empty.
class OutputFolder {
 public:
  // If another run works in the folder: throw an error; share it with runs that share it, too; or
  // wait until it ends.
  enum class Others { refuse, share, wait };

  // Throws InputError if `path` cannot be a folder, belongs to the system or to another user, is
  // not writable, or is used by another run. (On file systems without locks other runs are not
  // detected.)
  OutputFolder(const std::filesystem::path& path, Others others);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

 private:
  void make();
  void try_to_write() const;
  bool lock(Others others);
  void remove_empty() const;

  std::filesystem::path path_, made_;  // absolute; the outermost folder that was created
  int descriptor_ = -1;
};

// Ctrl-C, SIGTERM, SIGHUP and others: the program ends at once without leaving incomplete files.
//
// Create it at the start of main(), before other threads, which inherit the blocked signals. One
// thread waits for the signals and removes the temporary files of the folders in use. It then lets
// the signal end the program, as its parent process expects. Ignored signals (nohup) stay ignored.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  // A folder in use, together with missing folders above it, during the lifetime of this object.
  class Watch {
   public:
    Watch(Interruption& interruption, const std::filesystem::path& folder);
    ~Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

   private:
    Interruption& interruption_;
  };

 private:
  struct InUse {
    std::filesystem::path folder;
    size_t missing = 0;  // number of folders at the end of the path that did not exist
  };
  void wait();
  void clean(pid_t process) const;
  [[noreturn]] void end(int signal);

  sigset_t signals_{};
  std::atomic<bool> is_over_ = false;
  std::thread waiting_;
  std::mutex mutex_;
  std::vector<InUse> in_use_;
};

}  // namespace photorque
