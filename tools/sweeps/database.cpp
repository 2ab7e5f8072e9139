#include "tools/sweeps/database.h"

#include <sqlite3.h>

#include <chrono>
#include <limits>
#include <thread>

#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"

namespace photorque {
namespace {

constexpr int application = 0x70687471;  // "phtq", in the file's header
constexpr int format = 1;
constexpr int timeout_ms = 60000;  // for another process that writes

constexpr const char* schema = R"(
CREATE TABLE IF NOT EXISTS run(
  id INTEGER PRIMARY KEY, hash TEXT NOT NULL UNIQUE, command TEXT NOT NULL, program TEXT NOT NULL,
  changes TEXT NOT NULL, status INTEGER NOT NULL, error TEXT NOT NULL, wall_time_s REAL NOT NULL,
  finished TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS quantity(id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE);
CREATE TABLE IF NOT EXISTS figure(
  run INTEGER NOT NULL REFERENCES run(id), place INTEGER NOT NULL,
  quantity INTEGER NOT NULL REFERENCES quantity(id), value REAL NOT NULL, standard_error REAL,
  PRIMARY KEY(run, place)) WITHOUT ROWID;
CREATE VIEW IF NOT EXISTS figures AS
  SELECT run.id AS run, run.changes, quantity.name, figure.value, figure.standard_error
  FROM figure JOIN run ON run.id = figure.run JOIN quantity ON quantity.id = figure.quantity;
)";

// A text as a quoted column name in SQL.
std::string sql_name(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string joined(const Changes& changes) {
  return joined_text(changes, "\n");
}

}  // namespace

// A statement with bound values; errors are thrown as InputError of its database.
class RunDatabase::Statement {
 public:
  Statement(const RunDatabase& database, const std::string& sql) : database_(database) {
    if (sqlite3_prepare_v2(database.handle_, sql.c_str(), -1, &handle_, nullptr) != SQLITE_OK) {
      database.fail();
    }
  }
  ~Statement() { sqlite3_finalize(handle_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(int place, const std::string& text) {
    sqlite3_bind_text(handle_, place, text.c_str(), static_cast<int>(text.size()),
                      SQLITE_TRANSIENT);
    return *this;
  }
  Statement& bind(int place, int64_t value) {
    sqlite3_bind_int64(handle_, place, value);
    return *this;
  }
  // NaN becomes NULL.
  Statement& bind(int place, double value) {
    sqlite3_bind_double(handle_, place, value);
    return *this;
  }
  // Returns whether there is a row.
  bool step() {
    const int result = sqlite3_step(handle_);
    if (result != SQLITE_ROW && result != SQLITE_DONE) database_.fail();
    return result == SQLITE_ROW;
  }
  void again() { sqlite3_reset(handle_); }

  int64_t whole(int column) const { return sqlite3_column_int64(handle_, column); }
  double real(int column) const {
    return sqlite3_column_type(handle_, column) == SQLITE_NULL
               ? std::numeric_limits<double>::quiet_NaN()
               : sqlite3_column_double(handle_, column);
  }
  std::string text(int column) const {
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(handle_, column));
    return bytes == nullptr ? "" : bytes;
  }

 private:
  const RunDatabase& database_;
  sqlite3_stmt* handle_ = nullptr;
};

void RunDatabase::fail(const std::string& what) const {
  const int code = sqlite3_errcode(handle_) & 0xff;
  const bool damaged = !what.empty() || code == SQLITE_NOTADB || code == SQLITE_CORRUPT;
  throw InputError({path_.string()}, "", what.empty() ? sqlite3_errmsg(handle_) : what,
                   damaged ? "a database of designs; move it away to recompute all designs"
                           : "a database that can be read and written");
}

void RunDatabase::execute(const std::string& sql) const {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    // The error is thrown before the roll-back, which would discard the message.
    try {
      fail();
    } catch (...) {
      if (sqlite3_get_autocommit(handle_) == 0) {
        sqlite3_exec(handle_, "ROLLBACK", nullptr, nullptr, nullptr);
      }
      throw;
    }
  }
}

int RunDatabase::pragma(const std::string& name) const {
  Statement ask(*this, "PRAGMA " + name);
  return ask.step() ? static_cast<int>(ask.whole(0)) : 0;
}

RunDatabase::RunDatabase(const std::filesystem::path& path) : path_(path) {
  std::error_code none;
  if (std::filesystem::is_symlink(path, none)) {
    throw InputError({path.string()}, "", "a link", "a file of designs, or no such file");
  }
  // SQLite rejects links anywhere in a path; links to the folder are resolved first.
  const std::filesystem::path place =
      std::filesystem::weakly_canonical(std::filesystem::absolute(path).parent_path(), none) /
      path.filename();
  try {
    if (sqlite3_open_v2(place.c_str(), &handle_,
                        SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOFOLLOW,
                        nullptr) != SQLITE_OK) {
      fail();
    }
    sqlite3_busy_timeout(handle_, timeout_ms);
    prepare_tables();
  } catch (...) {
    sqlite3_close(handle_);
    throw;
  }
}

RunDatabase::~RunDatabase() {
  sqlite3_close(handle_);
}

// Rejects views or triggers in the place of tables: in a foreign file they may never end.
void RunDatabase::require_plain_tables() const {
  Statement others(*this,
                   "SELECT count(*) FROM sqlite_master WHERE type = 'trigger' OR "
                   "(lower(name) IN ('run', 'quantity', 'figure') AND "
                   "(type <> 'table' OR rootpage = 0))");
  if (others.step() && others.whole(0) > 0) fail("a database with other tables than a sweep's");
}

// WAL: readers do not wait for writers. FULL: committed runs survive a power failure.
void RunDatabase::prepare_tables() {
  Statement tables(*this, "SELECT count(*) FROM sqlite_master");
  const bool is_new = tables.step() && tables.whole(0) == 0;
  tables.again();
  const int found = pragma("application_id");
  // Another process may be writing the header of the same new file.
  if (found != application && !(is_new && found == 0)) fail("a database of another program");
  if (found == application && pragma("user_version") > format) {
    fail("a database of a newer version");
  }
  if (found == application) require_plain_tables();
  // Repeated, because SQLite does not wait here if two processes open a new file at the same time.
  const auto begin = std::chrono::steady_clock::now();
  while (sqlite3_exec(handle_, "PRAGMA journal_mode = WAL", nullptr, nullptr, nullptr) !=
         SQLITE_OK) {
    const bool busy = (sqlite3_errcode(handle_) & 0xff) == SQLITE_BUSY;
    const auto waited = std::chrono::steady_clock::now() - begin;
    if (!busy || waited > std::chrono::milliseconds(timeout_ms)) fail();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  execute("PRAGMA synchronous = FULL");
  if (found == application) return;
  in_transaction([&] {
    execute(schema);
    execute("PRAGMA application_id = " + std::to_string(application));
    execute("PRAGMA user_version = " + std::to_string(format));
  });
}

std::optional<RunOutcome> RunDatabase::find(const std::string& hash) const {
  Statement run(*this, "SELECT id, status, error FROM run WHERE hash = ?");
  if (!run.bind(1, hash).step()) return std::nullopt;
  RunOutcome outcome{{}, static_cast<int>(run.whole(1)), run.text(2)};
  Statement figures(*this,
                    "SELECT name, value, standard_error FROM figure JOIN quantity "
                    "ON quantity.id = figure.quantity WHERE run = ? ORDER BY place");
  figures.bind(1, run.whole(0));
  while (figures.step()) {
    outcome.figures.push_back({FigureName(figures.text(0)), {figures.real(1), figures.real(2)}});
  }
  if (!outcome.failed() && outcome.figures.empty()) fail("a run without figures");
  return outcome;
}

// Executes BEGIN IMMEDIATE, `work` and COMMIT; rolls back on errors.
void RunDatabase::in_transaction(const std::function<void()>& work) const {
  execute("BEGIN IMMEDIATE");
  try {
    work();
  } catch (...) {
    sqlite3_exec(handle_, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
  execute("COMMIT");
}

void RunDatabase::keep(const RunRecord& record) {
  in_transaction([&] {
    // Remove a failed run, and replace it.
    Statement(*this, "DELETE FROM run WHERE hash = ? AND status <> 0").bind(1, record.hash).step();
    Statement run(*this,
                  "INSERT OR IGNORE INTO run(hash, command, program, changes, status, error, "
                  "wall_time_s, finished) VALUES(?, ?, ?, ?, ?, ?, ?, datetime('now'))");
    run.bind(1, record.hash).bind(2, record.command).bind(3, record.program);
    run.bind(4, joined(record.changes)).bind(5, static_cast<int64_t>(record.outcome.status));
    run.bind(6, record.outcome.error).bind(7, record.wall_s).step();
    if (sqlite3_changes(handle_) > 0) {
      const int64_t id = sqlite3_last_insert_rowid(handle_);
      Statement quantity(*this, "INSERT OR IGNORE INTO quantity(name) VALUES(?)");
      Statement figure(*this,
                       "INSERT INTO figure(run, place, quantity, value, standard_error) "
                       "VALUES(?, ?, (SELECT id FROM quantity WHERE name = ?), ?, ?)");
      int64_t place = 0;
      for (const Figure& f : record.outcome.figures) {
        quantity.bind(1, f.name.text()).step();
        quantity.again();
        figure.bind(1, id).bind(2, place++).bind(3, f.name.text()).bind(4, f.estimate.value);
        figure.bind(5, f.estimate.standard_error).step();
        figure.again();
      }
    }
  });
}

std::set<std::string> RunDatabase::failed() const {
  std::set<std::string> all;
  Statement runs(*this, "SELECT hash FROM run WHERE status <> 0");
  while (runs.step()) all.insert(runs.text(0));
  return all;
}

void RunDatabase::take_from(const std::filesystem::path& other) {
  { const RunDatabase check(other); }
  Statement(*this, "ATTACH ? AS other").bind(1, other.string()).step();
  try {
    execute(R"(
BEGIN IMMEDIATE;
DELETE FROM run WHERE status <> 0 AND hash IN (SELECT hash FROM other.run);
CREATE TEMP TABLE IF NOT EXISTS taken(id INTEGER, hash TEXT);
DELETE FROM taken;
INSERT INTO taken SELECT id, hash FROM other.run WHERE hash NOT IN (SELECT hash FROM main.run);
INSERT INTO run(hash, command, program, changes, status, error, wall_time_s, finished)
  SELECT hash, command, program, changes, status, error, wall_time_s, finished
  FROM other.run WHERE id IN (SELECT id FROM taken);
INSERT OR IGNORE INTO quantity(name) SELECT name FROM other.quantity;
INSERT INTO figure(run, place, quantity, value, standard_error)
  SELECT r.id, f.place, q.id, f.value, f.standard_error FROM other.figure AS f
  JOIN taken ON taken.id = f.run JOIN main.run AS r ON r.hash = taken.hash
  JOIN other.quantity AS n ON n.id = f.quantity JOIN main.quantity AS q ON q.name = n.name;
COMMIT)");
  } catch (...) {
    sqlite3_exec(handle_, "DETACH other", nullptr, nullptr, nullptr);
    throw;
  }
  execute("DETACH other");
}

void RunDatabase::write_designs(const Table& table) {
  const size_t rows = table.columns.front().size();
  std::string columns, places;
  for (const Table::Column& column : table.columns) {
    columns += (columns.empty() ? "" : ", ") + sql_name(column.name) +
               (column.texts.empty() ? " REAL" : " TEXT");
    places += places.empty() ? "?" : ", ?";
  }
  in_transaction([&] {
    execute("DROP TABLE IF EXISTS designs");
    execute("CREATE TABLE designs(" + columns + ")");
    Statement insert(*this, "INSERT INTO designs VALUES(" + places + ")");
    for (size_t row = 0; row < rows; ++row) {
      int place = 1;
      for (const Table::Column& column : table.columns) {
        if (column.texts.empty()) {
          insert.bind(place++, column.values[row]);
        } else {
          insert.bind(place++, column.texts[row]);
        }
      }
      insert.step();
      insert.again();
    }
  });
}

void RunDatabase::copy_to(const std::filesystem::path& path) const {
  write_file_whole(path, [this](const std::filesystem::path& temporary) {
    std::filesystem::remove(temporary);  // VACUUM requires that it does not exist
    Statement(*this, "VACUUM INTO ?").bind(1, temporary.string()).step();
  });
}

}  // namespace photorque
