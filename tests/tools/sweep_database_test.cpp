// Nothing that a sweep has found is lost, and nothing is found twice: kills, full disks, processes
// side by side, shards, and files whose content changed.
#include <sys/mount.h>

#include <chrono>
#include <random>
#include <regex>
#include <thread>

#include "tests/tools/sweep_test.h"

namespace photorque {
namespace {

using testing::HasSubstr;

constexpr const char* forty = R"([sweep]
verb = "trace"
figures = ["power_on_plate_W", "emitted_W"]
maximise = "power_on_plate_W"
axis = [{ key = "attitude.tilt_deg", from = 0, to = 39, count = 40 }]
)";

class SweepDatabase : public SweepTest {
 protected:
  void SetUp() override {
    SweepTest::SetUp();
    write_plate();
    experiment(forty);
  }
  // The table of a sweep without disturbance.
  std::string reference() const {
    const Outcome got = sweep("", "reference");
    EXPECT_EQ(got.status, 0) << got.err;
    return file_text(at("reference/sweep.csv"));
  }
  std::string database() const { return at("out/designs.sqlite"); }
  // 0 where the database is not made yet.
  int runs_so_far() const { return fs::exists(database()) ? count("SELECT count(*) FROM run") : 0; }
  int count(const std::string& sql) const {
    const auto rows = query(database(), sql);
    return rows.empty() ? -1 : std::atoi(rows[0][0].c_str());
  }
  static int number_before(const std::string& text, const std::string& words) {
    std::smatch match;
    return std::regex_search(text, match, std::regex("([0-9]+) " + words)) ? std::stoi(match[1])
                                                                           : -1;
  }
};

// SQLite would write through it, into whatever file of the user's a foreign folder names.
TEST_F(SweepDatabase, ALinkIsRefused) {
  fs::create_directories(at("out"));
  fs::create_symlink(at("victim"), database());
  EXPECT_THAT(refusal_in(sweep()), HasSubstr("a link"));
  EXPECT_FALSE(fs::exists(at("victim")));
}

TEST_F(SweepDatabase, LosesNothingByKills) {
  experiment(std::regex_replace(std::string(forty), std::regex("count = 40"), "count = 250"));
  const std::string whole = reference();
  std::mt19937 moments(15);
  int runs = 0;
  for (int k = 0; k < 10; ++k) {
    const pid_t child = start("");
    // At any moment of the start or, more often, after some more designs, at any moment of the
    // next.
    const int more = static_cast<int>(moments() % 12);
    while (k % 4 != 0 && runs_so_far() < runs + more) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::this_thread::sleep_for(
        std::chrono::microseconds(moments() % (k % 4 == 0 ? 150000 : 20000)));
    kill_process(child);
    if (!fs::exists(database())) continue;
    ASSERT_EQ(query(database(), "PRAGMA integrity_check")[0][0], "ok");
    if (count("SELECT count(*) FROM sqlite_master") == 0) continue;  // killed while it was made
    const int now = count("SELECT count(*) FROM run");
    EXPECT_GE(now, runs) << "kill " << k;
    runs = now;
    // Every run is there with all of its figures.
    EXPECT_LE(count("SELECT count(DISTINCT n) FROM (SELECT count(*) AS n FROM run LEFT JOIN figure "
                    "ON figure.run = run.id GROUP BY run.id)"),
              1);
    EXPECT_EQ(count("SELECT count(*) FROM run WHERE id NOT IN (SELECT run FROM figure)"), 0);
  }
  EXPECT_GT(runs, 0);
  EXPECT_LT(runs, 251);
  const Outcome last = sweep();
  ASSERT_EQ(last.status, 0) << last.err;
  EXPECT_EQ(number_before(last.out, "kept from before"), runs);
  EXPECT_EQ(file_text(at("out/sweep.csv")), whole);
}

TEST_F(SweepDatabase, IsSharedByProcessesThatDoEachDesignOnce) {
  const std::string whole = reference();
  std::vector<pid_t> all;
  for (int i = 0; i < 3; ++i) all.push_back(start("", "out", at("said" + std::to_string(i))));
  int made = 0;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(end_of(all[static_cast<size_t>(i)]), 0);
    made += number_before(file_text(at("said" + std::to_string(i))), "run now");
  }
  EXPECT_EQ(made, 41);  // with the nominal experiment
  EXPECT_EQ(count("SELECT count(*) FROM run"), 41);
  EXPECT_EQ(file_text(at("out/sweep.csv")), whole);
}

TEST_F(SweepDatabase, GoesOnWhenTheDiskHasSpaceAgain) {
  const std::string whole = reference();
  fs::create_directories(at("out"));
  if (::mount("tmpfs", at("out").c_str(), "tmpfs", 0, "size=300k") != 0) {
    GTEST_SKIP() << "no right to mount";
  }
  EXPECT_THAT(refusal_in(sweep()), HasSubstr("designs.sqlite"));
  EXPECT_EQ(::mount("tmpfs", at("out").c_str(), "tmpfs", MS_REMOUNT, "size=32m"), 0);
  const int kept = count("SELECT count(*) FROM run");
  const Outcome after = sweep();
  const std::string table = file_text(at("out/sweep.csv"));
  ::umount(at("out").c_str());
  ASSERT_EQ(after.status, 0) << after.err;
  EXPECT_GT(kept, 0);
  EXPECT_LT(kept, 41);
  EXPECT_EQ(number_before(after.out, "kept from before"), kept);
  EXPECT_EQ(table, whole);
}

TEST_F(SweepDatabase, InAReadOnlyFolderIsOneLine) {
  fs::create_directories(at("disk"));
  if (::mount("tmpfs", at("disk").c_str(), "tmpfs", MS_RDONLY, "size=1m") != 0) {
    GTEST_SKIP() << "no right to mount";
  }
  const Outcome got = sweep("", "disk/out");
  ::umount(at("disk").c_str());
  EXPECT_THAT(refusal_in(got), HasSubstr("--out"));
}

TEST_F(SweepDatabase, RecognisesFilesByTheirContent) {
  ASSERT_EQ(sweep().status, 0);
  const std::string small = file_text(at("out/sweep.csv"));
  // Equal content at another time, and an experiment with equal meaning in other words.
  write_plate();
  experiment("# a comment\n" + std::string(forty));
  EXPECT_THAT(sweep().out, HasSubstr("0 run now, 41 kept"));
  EXPECT_THAT(sweep("--seed 9").out, HasSubstr("41 run now, 0 kept"));
  // Twice the edge: another buffer of the model that the experiment names.
  write_plate(2.0 * edge_m);
  EXPECT_THAT(sweep().out, HasSubstr("41 run now, 0 kept"));
  const auto now_W = csv_column(at("out/sweep.csv"), "power_on_plate_W");
  write("small.csv", small);
  const auto before_W = csv_column(at("small.csv"), "power_on_plate_W");
  EXPECT_NEAR(now_W.at(0) / before_W.at(0), 4.0, 1e-3);
}

TEST_F(SweepDatabase, OfShardsGivesTheSameTableWhenOneWasKilled) {
  const std::string whole = reference();
  const pid_t second = start("--shard 2/3");
  const std::string own = at("out/shards/2-of-3.sqlite");
  while (std::atoi(query(own, "SELECT count(*) FROM run")[0][0].c_str()) < 3) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  kill_process(second);
  EXPECT_THAT(sweep("--shard 1/3").out, HasSubstr("not all shards are done"));
  EXPECT_THAT(sweep("--shard 3/3").out, HasSubstr("not all shards are done"));
  EXPECT_FALSE(fs::exists(at("out/sweep.csv")));
  const Outcome part = sweep("--collect");
  EXPECT_EQ(part.status, 0) << part.err;
  EXPECT_THAT(part.out, HasSubstr("WARNING"));
  EXPECT_THAT(file_text(at("out/sweep.csv")), HasSubstr("not run yet"));
  const int missing = number_before(part.out, "missing");
  EXPECT_GT(missing, 0);
  EXPECT_LT(missing, 41);
  const Outcome last = sweep("--shard 2/3");
  EXPECT_EQ(number_before(last.out, "run now"), missing);
  EXPECT_EQ(file_text(at("out/sweep.csv")), whole);
}

// Variables that Slurm sets for the tasks of an array; tests/slurm has a cluster.
TEST_F(SweepDatabase, OfAnArrayOfTasksIsThatOfItsShards) {
  const std::string whole = reference();
  const auto task = [this](const std::string& variables) {
    const std::string command = variables +
                                " PHOTORQUE=" PHOTORQUE_BINARY_DIR
                                "/photorque " PHOTORQUE_SOURCE_DIR "/tools/slurm/sweep " +
                                at("e.toml") + " --out " + at("out") + " >" + at("said") + " 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  EXPECT_NE(task("SLURM_ARRAY_TASK_MAX=2"), 0);
  EXPECT_THAT(file_text(at("said")), HasSubstr("sbatch --array=1-N"));
  EXPECT_EQ(task("SLURM_ARRAY_TASK_ID=0 SLURM_ARRAY_TASK_MAX=2"), 2);
  EXPECT_FALSE(fs::exists(at("out")));
  EXPECT_EQ(task("SLURM_ARRAY_TASK_ID=2 SLURM_ARRAY_TASK_MAX=2"), 0);
  EXPECT_TRUE(fs::exists(at("out/shards/2-of-2.done.sqlite")));
  EXPECT_EQ(task("SLURM_ARRAY_TASK_ID=1 SLURM_ARRAY_TASK_MAX=1 PHOTORQUE_SHARDS=2"), 0);
  EXPECT_EQ(file_text(at("out/sweep.csv")), whole);
}

TEST_F(SweepDatabase, ThatIsNoneIsNamed) {
  fs::create_directories(at("out"));
  for (const std::string& damage : {std::string(5000, 'x'), std::string("SQLite format 3")}) {
    std::ofstream(database()) << damage;
    EXPECT_THAT(refusal_in(sweep()),
                testing::AllOf(HasSubstr("designs.sqlite"), HasSubstr("move it away")));
  }
  fs::remove(database());
  sqlite3* other = nullptr;
  sqlite3_open(database().c_str(), &other);
  sqlite3_exec(other, "CREATE TABLE mine(x); INSERT INTO mine VALUES(1)", nullptr, nullptr,
               nullptr);
  sqlite3_close(other);
  EXPECT_THAT(sweep().err, HasSubstr("another program"));
  EXPECT_EQ(count("SELECT x FROM mine"), 1);
}

// Found by reading for it: a view that counts without end in the place of a table was asked for its
// rows; a trigger would have been run by whatever is kept.
TEST_F(SweepDatabase, WithViewsOrTriggersThatNeverEndIsRefused) {
  for (const char* change :
       {"DROP VIEW figures; DROP TABLE run; CREATE VIEW run AS WITH RECURSIVE n(x) AS "
        "(SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x AS id, 'a' AS hash, 1 AS status, "
        "'' AS error FROM n",
        "CREATE TRIGGER t AFTER INSERT ON run BEGIN INSERT INTO quantity(name) WITH RECURSIVE "
        "n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT 'q' || x FROM n; END"}) {
    fs::remove_all(at("out"));
    ASSERT_EQ(sweep().status, 0);
    EXPECT_THAT(query(database(), change), testing::IsEmpty()) << change;
    EXPECT_THAT(refusal_in(sweep()), HasSubstr("other tables than a sweep's"));
  }
}

TEST_F(SweepDatabase, HoldsTheTableForOtherTools) {
  ASSERT_EQ(sweep().status, 0);
  const auto table = csv_rows(at("out/sweep.csv"));
  const auto designs = query(database(), "SELECT * FROM designs");
  ASSERT_EQ(designs.size() + 1, table.size());
  for (size_t r = 0; r < designs.size(); ++r) {
    for (size_t c = 0; c < designs[r].size(); ++c) {
      EXPECT_NEAR(std::stod(designs[r][c]), std::stod(table[r + 1][c]),
                  1e-12 * std::abs(std::stod(table[r + 1][c])));
    }
  }
  EXPECT_EQ(query(database(), "PRAGMA journal_mode")[0][0], "wal");
  EXPECT_EQ(count("SELECT count(*) FROM figures WHERE name = 'power_on_plate_W'"), 41);
}

}  // namespace
}  // namespace photorque
