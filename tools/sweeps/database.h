// The runs of a sweep in one SQLite file. The only place for SQLite.
//
// A run is one row of `run` with its rows of `figure`, written in one transaction: it is stored
// completely or not at all, even if the process is killed. The view `figures` joins names and
// values; `designs` is the table of the last sweep for other tools that read SQLite.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include "core/product.h"
#include "tools/sweeps/outcome.h"

struct sqlite3;

namespace photorque {

struct RunRecord {
  std::string hash;     // of all inputs of the run: see RunIdentity
  std::string command;  // "power"
  std::string program;  // version and git hash
  Changes changes;
  RunOutcome outcome;
  double wall_s = 0.0;
};

// An open database. Several processes of one machine may open it; a write waits for those of
// others. Throws InputError with the name of the file: not a database, of another program, damaged,
// disk full, no permission.
class RunDatabase {
 public:
  // Creates the file if it is missing.
  explicit RunDatabase(const std::filesystem::path& path);
  ~RunDatabase();
  RunDatabase(const RunDatabase&) = delete;
  RunDatabase& operator=(const RunDatabase&) = delete;

  // The run with this hash, if it exists.
  std::optional<RunOutcome> find(const std::string& hash) const;
  // Stores a run. It replaces a failed run, but not a successful one.
  void keep(const RunRecord& record);
  // Hashes of failed runs.
  std::set<std::string> failed() const;
  // Copies those runs of another database that are missing or failed here.
  void take_from(const std::filesystem::path& other);
  // Replaces the table `designs`.
  void write_designs(const Table& table);
  // Writes an independent copy, which gets its name when it is complete.
  void copy_to(const std::filesystem::path& path) const;

 private:
  class Statement;
  void execute(const std::string& sql) const;
  void in_transaction(const std::function<void()>& work) const;
  int pragma(const std::string& name) const;
  void prepare_tables();
  void require_plain_tables() const;
  [[noreturn]] void fail(const std::string& what = "") const;

  std::filesystem::path path_;
  sqlite3* handle_ = nullptr;
};

}  // namespace photorque
