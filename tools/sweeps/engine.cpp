#include "tools/sweeps/engine.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "core/errors.h"
#include "core/files.h"
#include "core/provenance.h"
#include "tools/runs/result.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

constexpr const char* shard_folder = "shards";
constexpr std::string_view done_suffix = ".done.sqlite", database_suffix = ".sqlite";

std::string shard_name(size_t number, size_t count) {
  return std::to_string(number) + "-of-" + std::to_string(count);
}

// Removes "--set: " from the error of a run: the values of its plan are applied as if by --set.
std::string without_origin(const std::string& text) {
  constexpr std::string_view by_set = "--set: ";
  return text.starts_with(by_set) ? text.substr(by_set.size()) : text;
}

int64_t byte_of(const std::string& name) {
  constexpr size_t digits = 15;  // of 60 bits, because offsets are signed
  return static_cast<int64_t>(std::stoull(content_hash(name).substr(0, digits), nullptr, 16));
}

// These locks belong to the open file, not to the process, so that they also work between two users
// in one process.
bool lock_byte(int descriptor, int64_t byte, short how, bool wait) {
  struct flock range {};
  range.l_type = how;
  range.l_whence = SEEK_SET;
  range.l_start = byte;
  range.l_len = 1;
  int result = 0;
  do {
    result = ::fcntl(descriptor, wait ? F_OFD_SETLKW : F_OFD_SETLK, &range);
  } while (result != 0 && errno == EINTR);
  return result == 0 || (errno != EAGAIN && errno != EACCES);
}

}  // namespace

Claims::Claims(const std::filesystem::path& path)
    : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) {
    throw InputError({path.string()}, "", std::strerror(errno), "a file that can be written");
  }
}

Claims::~Claims() {
  ::close(descriptor_);
}

Claims::Claim Claims::take(const std::string& name, bool waits) const {
  const int64_t byte = byte_of(name);
  if (!lock_byte(descriptor_, byte, F_WRLCK, waits)) return nullptr;
  return {this,
          [byte](const Claims* claims) { lock_byte(claims->descriptor_, byte, F_UNLCK, false); }};
}

fs::path SweepFiles::shard(size_t number, size_t count) const {
  return folder / shard_folder / (shard_name(number, count) + std::string(database_suffix));
}

fs::path SweepFiles::done_shard(size_t number, size_t count) const {
  return folder / shard_folder / (shard_name(number, count) + std::string(done_suffix));
}

std::vector<fs::path> SweepFiles::shards(bool unfinished) const {
  std::vector<fs::path> all;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder / shard_folder, none)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.') || !name.ends_with(database_suffix)) continue;
    if (unfinished || name.ends_with(done_suffix)) all.push_back(entry.path());
  }
  std::ranges::sort(all);
  return all;
}

RunEngine::RunEngine(Task task)
    : task_(std::move(task)),
      identity_(task_.options, task_.command),
      claims_path_(fs::path(task_.database).replace_extension("lock")) {
  if (task_.database.has_parent_path()) make_folders(task_.database.parent_path());
  claims_ = std::make_unique<Claims>(claims_path_);
  if (!fs::exists(task_.database)) return;
  failed_before_ = database().failed();
}

// A sweep without any successful run leaves no file.
RunEngine::~RunEngine() {
  if (database_) return;
  std::error_code ignored;
  fs::remove(claims_path_, ignored);
  const fs::path own = claims_path_.parent_path();
  if (own.filename() == shard_folder) fs::remove(own, ignored);
}

RunDatabase& RunEngine::database() {
  if (!database_) {
    database_ = std::make_unique<RunDatabase>(task_.database);
    for (const auto& [hash, record] : not_kept_yet_) database_->keep(record);
    not_kept_yet_.clear();
  }
  return *database_;
}

std::optional<RunOutcome> RunEngine::stored(const std::string& hash) {
  const auto at = not_kept_yet_.find(hash);
  if (at != not_kept_yet_.end()) return at->second.outcome;
  // Another process may have created the file meanwhile.
  if (!database_ && !fs::exists(task_.database)) return std::nullopt;
  if (!failed_before_.contains(hash)) return database().find(hash);
  std::optional<RunOutcome> found = database().find(hash);
  if (found && found->failed()) return std::nullopt;
  return found;
}

RunOutcome RunEngine::make(const Changes& changes) {
  RunOptions run = task_.options;
  run.overrides.insert(run.overrides.end(), changes.begin(), changes.end());
  try {
    return {task_.run(run), 0, ""};
  } catch (const InputError& error) {
    return {{}, 2, without_origin(error.what())};
  } catch (const std::filesystem::filesystem_error& error) {
    return {{}, 2, error.what()};
  } catch (const NumericalError& error) {
    return {{}, 3, std::string("numerical failure: ") + error.what()};
  }
}

void RunEngine::keep(RunRecord record) {
  failed_before_.erase(record.hash);
  if (record.outcome.failed() && !database_) {
    not_kept_yet_[record.hash] = std::move(record);
    return;
  }
  database().keep(record);
}

// Makes or reads one run. Returns false if another process is making it.
bool RunEngine::settle(const Changes& changes, RunOutcome& outcome) {
  std::string hash;
  try {
    hash = identity_.of(changes);
  } catch (const InputError& error) {
    outcome = {{}, 2, without_origin(error.what())};
    return true;
  }
  std::optional<RunOutcome> found = stored(hash);
  Claims::Claim claim;
  if (!found) {
    claim = claims_->take(hash);
    if (!claim) return false;
    found = stored(hash);
  }
  if (found) {
    outcome = std::move(*found);
    ++kept_;
    return true;
  }
  const WallTime wall;
  outcome = make(changes);
  ++made_;
  if (!outcome.failed() && task_.first) {
    task_.first(outcome.figures);
    task_.first = {};
  }
  const Provenance build = build_provenance();
  keep({hash, task_.command, build.version + " " + build.git_hash, changes, outcome,
        wall.elapsed_s()});
  return true;
}

std::vector<RunOutcome> RunEngine::outcomes(std::span<const Changes> runs,
                                            const std::function<void(double)>& progress) {
  std::vector<RunOutcome> all(runs.size());
  std::vector<size_t> open(runs.size());
  for (size_t i = 0; i < open.size(); ++i) open[i] = i;
  while (!open.empty()) {
    std::vector<size_t> others;
    for (size_t k = 0; k < open.size(); ++k) {
      RunOutcome& outcome = all[open[k]];
      if (!settle(runs[open[k]], outcome)) others.push_back(open[k]);
      names_.share(outcome.figures);
      const size_t left = open.size() - k - 1 + others.size();
      if (progress) {
        progress(1.0 - static_cast<double>(left) / static_cast<double>(runs.size()));
      }
    }
    if (others.size() == open.size()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    open = std::move(others);
  }
  return all;
}

std::vector<std::optional<RunOutcome>> RunEngine::kept_outcomes(std::span<const Changes> runs) {
  std::vector<std::optional<RunOutcome>> all;
  for (const Changes& changes : runs) {
    try {
      const std::string hash = identity_.of(changes);
      const auto at = not_kept_yet_.find(hash);
      all.push_back(at != not_kept_yet_.end() ? at->second.outcome
                    : database_               ? database_->find(hash)
                                              : std::nullopt);
      if (all.back()) names_.share(all.back()->figures);
    } catch (const InputError& error) {
      all.push_back(RunOutcome{{}, 2, without_origin(error.what())});
    }
  }
  return all;
}

}  // namespace photorque
