// The runs of a sweep in one SQLite file. The only place for SQLite.
//
// A run is one row of `run` with its rows of `figure`, written in one transaction: it is there
// whole or not at all, whenever the process is killed. The view `figures` has names and values side
// by side; `designs` is the table of the last sweep, for any tool that reads SQLite.
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
  std::string hash;     // of all that the run follows from: see RunIdentity
  std::string command;  // "power"
  std::string program;  // version and git hash
  Changes changes;
  RunOutcome outcome;
  double wall_s = 0.0;
};

// An open database. Any number of processes of one machine may have it open; each write waits for
// those of others. InputError names the file: no database, not ours, damaged, disk full, no right.
class RunDatabase {
 public:
  // Made where there is none.
  explicit RunDatabase(const std::filesystem::path& path);
  ~RunDatabase();
  RunDatabase(const RunDatabase&) = delete;
  RunDatabase& operator=(const RunDatabase&) = delete;

  // The run with this hash, if it exists.
  std::optional<RunOutcome> find(const std::string& hash) const;
  // Keeps a run, in place of one that failed; one that succeeded stays.
  void keep(const RunRecord& record);
  // The hashes of runs that failed.
  std::set<std::string> failed() const;
  // Takes over every run of another database that is not here, or failed here only.
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
