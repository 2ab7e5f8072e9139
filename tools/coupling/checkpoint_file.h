// The file that a run which takes long keeps its state in, so that it can be broken off.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

namespace photorque {

// A line of text for each of: format, width of the table of light, hash of that and of all that the
// run follows from, hash of the state; then the state. Written whole or not at all, over the last
// one.
class CheckpointFile {
 public:
  CheckpointFile(std::filesystem::path path, double every_s);

  struct Kept {
    double table_tilt_rad = 0.0;  // how far the table of light reached; 0 without one
    std::string state;
  };
  // What the file holds of the run that follows from `identity`, program and inputs; nothing where
  // there is no file. InputError for the state of another run and for a file that is damaged.
  std::optional<Kept> read(const std::string& identity);

  // Whether the time between two states has passed.
  bool due() const { return std::chrono::steady_clock::now() >= next_; }
  // InputError when it cannot be written; what was there stays.
  void write(const std::string& identity, double table_tilt_rad, const std::string& state);

  const std::filesystem::path& path() const { return path_; }

 private:
  void wait();

  std::filesystem::path path_;
  std::chrono::steady_clock::duration every_;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace photorque
