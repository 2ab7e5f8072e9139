// Runs of a sweep, read from its database or computed and stored there.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "tools/sweeps/database.h"
#include "tools/sweeps/identity.h"

namespace photorque {

// The files of a sweep in its output folder. A shard has a separate database, because shards may
// run on several machines, and SQLite shares a file only among processes of one machine. When a
// shard ends, it writes a final copy of its database.
struct SweepFiles {
  std::filesystem::path folder;
  std::filesystem::path database() const { return folder / "designs.sqlite"; }
  std::filesystem::path shard(size_t number, size_t count) const;       // shards/3-of-8.sqlite
  std::filesystem::path done_shard(size_t number, size_t count) const;  // shards/3-of-8.done.sqlite
  // The existing databases of shards; with `unfinished` also those of incomplete shards.
  std::vector<std::filesystem::path> shards(bool unfinished) const;
};

// Claims on runs and other names by the processes that work on one database, as locks on bytes of a
// file. The system releases them when a process ends for any reason. Two names share a byte once in
// 10^18 pairs; the second then waits. (On file systems without locks all claims succeed.)
class Claims {
 public:
  // A claim on a run; released by its last copy.
  using Claim = std::shared_ptr<const void>;

  // Creates the file if it is missing.
  explicit Claims(const std::filesystem::path& path);
  ~Claims();
  Claims(const Claims&) = delete;
  Claims& operator=(const Claims&) = delete;

  // Claims a name. If another process has it: null, or `waits` until it is released.
  Claim take(const std::string& name, bool waits = false) const;

 private:
  int descriptor_ = -1;
};

class RunEngine {
 public:
  struct Task {
    RunOptions options;
    std::string command;
    std::filesystem::path database;
    // Runs the command and returns its figures; throws its errors.
    std::function<std::vector<Figure>(const RunOptions&)> run;
    // Called with the figures of the first run that succeeds.
    std::function<void(const std::vector<Figure>&)> first = {};
  };
  explicit RunEngine(Task task);
  ~RunEngine();
  RunEngine(const RunEngine&) = delete;
  RunEngine& operator=(const RunEngine&) = delete;

  // The outcomes of these runs, in order. Computes missing and previously failed runs, and waits
  // for those that another process computes. `progress` may be empty.
  std::vector<RunOutcome> outcomes(std::span<const Changes> runs,
                                   const std::function<void(double)>& progress = {});
  // The stored outcomes, in order; empty for runs that are not stored.
  std::vector<std::optional<RunOutcome>> kept_outcomes(std::span<const Changes> runs);

  size_t made() const { return made_; }
  size_t kept() const { return kept_; }

  // The database; created if missing.
  RunDatabase& database();
  bool has_database() const { return database_ != nullptr; }
  Claims::Claim wait_for_others(const std::string& name) { return claims_->take(name, true); }
  RunIdentity& identity() { return identity_; }

 private:
  bool settle(const Changes& changes, RunOutcome& outcome);
  std::optional<RunOutcome> stored(const std::string& hash);
  RunOutcome make(const Changes& changes);
  void keep(RunRecord record);

  Task task_;
  RunIdentity identity_;
  FigureNames names_;
  std::filesystem::path claims_path_;
  std::unique_ptr<Claims> claims_;
  std::unique_ptr<RunDatabase> database_;          // null until a run is stored
  std::set<std::string> failed_before_;            // hashes of runs to be recomputed
  std::map<std::string, RunRecord> not_kept_yet_;  // failed runs before the first success
  size_t made_ = 0, kept_ = 0;
};

}  // namespace photorque
