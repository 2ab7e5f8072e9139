// The folder that a command writes into: made, tried, locked and cleaned before the work; left
// clean when a signal ends the program.
#pragma once

#include <atomic>
#include <csignal>
#include <filesystem>
#include <mutex>
#include <thread>
#include <vector>

namespace photorque {

// A folder in which one run works. What killed runs left in it is removed. When it ends, folders
// that it made and that are still empty go away.
class OutputFolder {
 public:
  // Handling of other runs that work in the folder: refuse to; let those in that share as well;
  // wait until they are done.
  enum class Others { refuse, share, wait };

  // InputError when `path` is no folder or cannot be one, when it belongs to the system or to
  // another user, when a file in it cannot be written, or when another run works there. (File
  // systems without locks: no other is excluded.)
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

// Ctrl-C, SIGTERM, SIGHUP and others: the program ends at once and leaves no half-written file
// behind.
//
// Made first thing in main(), before other threads are, which inherit that they are not to be
// interrupted: one thread waits for the signals, removes the temporary files of the folders in use,
// and lets the signal end the program, as its parent process expects. Signals that are ignored
// (nohup) stay so.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  // A folder in use, and those above it that are not there yet, as long as it lives.
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
    size_t missing = 0;  // folders at the end of the path that were not there
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
