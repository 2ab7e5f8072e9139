// Real recordings of others (docs/real.md) as they come after a mistake: a unit in the header that
// is wrong, an axis reversed, a clock stretched, rows gone, columns exchanged. Each gets the right
// finding, or a refusal that names the column.
#include <nlohmann/json.hpp>

#include "attitude/recordings/text_lines.h"
#include "core/constants.h"
#include "core/text/parse.h"
#include "tests/outside.h"
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using testing::HasSubstr;
using testing::IsSupersetOf;

// A table of numbers; a cell that is none is kept as it is.
struct CopiedTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;

  void exchange(size_t a, size_t b) {
    for (auto& row : rows) std::swap(row[a], row[b]);
  }
  void multiply(size_t column, double factor) {
    for (auto& row : rows) row[column] = shortest(*number_in(row[column]) * factor);
  }
  // Only the rows whose number modulo `of` is `low` or more.
  void thin(size_t of, size_t low) {
    std::vector<std::vector<std::string>> kept;
    for (size_t i = 0; i < rows.size(); ++i) {
      if (i % of >= low) kept.push_back(rows[i]);
    }
    rows = std::move(kept);
  }
  std::string text() const {
    std::string all;
    const auto line = [&](const std::vector<std::string>& cells) {
      for (size_t i = 0; i < cells.size(); ++i) all += (i > 0 ? "," : "") + cells[i];
      all += "\n";
    };
    line(header);
    for (const auto& row : rows) line(row);
    return all;
  }
};

CopiedTable table_of(const std::string& recording) {
  TextLines lines(photorque::outside::third_party("recordings/" + recording));
  CopiedTable table;
  std::string_view line;
  while (lines.next(line)) {
    if (line.starts_with("#") || trimmed(line).empty()) continue;
    const std::vector<std::string_view> cells = cells_of(line);
    std::vector<std::string> row(cells.begin(), cells.end());
    if (table.header.empty()) {
      table.header = std::move(row);
    } else {
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

class MutilatedRecordings : public CommandTest {
 protected:
  void SetUp() override {
    PHOTORQUE_NEEDS_THIRD_PARTY("recordings");
    CommandTest::SetUp();
  }
  // Arguments that diagnose it with an experiment of docs/real.
  std::string diagnose(const std::string& experiment, const CopiedTable& table) const {
    return "diagnose " + source_folder + "/docs/real/" + experiment + ".toml --recording " +
           write("copy.csv", table.text()) + " --json --quiet --out " + at("out");
  }
  void expect_found(const std::string& experiment, const CopiedTable& table,
                    const std::vector<std::string>& names, const std::string& note) const {
    const auto answer = nlohmann::json::parse(succeed(diagnose(experiment, table)).out);
    EXPECT_THAT(kinds_in(answer), IsSupersetOf(names));
    EXPECT_THAT(answer.at("warnings").dump(), HasSubstr(note));
  }
  void expect_refused(const std::string& experiment, const CopiedTable& table,
                      const std::string& what) const {
    EXPECT_THAT(refused(diagnose(experiment, table)), HasSubstr(what));
  }
};

// t_s, gyro x y z, accelerometer x y z, wheel z.
TEST_F(MutilatedRecordings, ThrowsWithAWheel) {
  CopiedTable thrown = table_of("throw_flywheel/body_37.csv.gz");
  thrown.thin(8, 7);  // 4000 rows a second would take five times as long and say no more
  CopiedTable exchanged = thrown, wheel = thrown;
  exchanged.exchange(1, 2);
  expect_found("throw_flywheel", exchanged, {"wheel_momentum"}, "the gyro's axes");
  wheel.multiply(7, -1.0);
  expect_found("throw_flywheel", wheel, {"wheel_momentum"},
               "the sign of wheel_z_rad_s was reversed");
}

TEST_F(MutilatedRecordings, Racquets) {
  const CopiedTable flight = table_of("racquet_tumble/flight_075.csv.gz");
  CopiedTable reversed = flight, degrees = flight, thinner = flight;
  reversed.multiply(1, -1.0);
  expect_found("racquet_tumble", reversed, {"air_pressure_drag"}, "the gyro's axes");
  for (size_t k = 1; k < 4; ++k) degrees.multiply(k, 1.0 / degree_rad);
  expect_found("racquet_tumble", degrees, {"air_pressure_drag"},
               "the gyro reads degrees per second");
  thinner.thin(3, 1);
  expect_found("racquet_tumble", thinner, {"air_pressure_drag"}, "");
}

TEST_F(MutilatedRecordings, AWheel) {
  const CopiedTable wheel = table_of("wheel_coastdown/grandprix406_left_120psi.csv.gz");
  CopiedTable reversed = wheel, exchanged = wheel, slow = wheel;
  reversed.multiply(1, -1.0);
  expect_found("wheel_coastdown", reversed, {"dry_friction", "air_pressure_drag"}, "");
  // About one axis neither the unit nor the clock shows: the names stay, the torques change.
  slow.header[1] = "gyro_z_rpm";
  slow.multiply(0, 1.5);
  expect_found("wheel_coastdown", slow, {"dry_friction", "air_pressure_drag"}, "");
  exchanged.exchange(0, 1);
  expect_refused("wheel_coastdown", exchanged, "t_s: found times that fall");
}

TEST_F(MutilatedRecordings, AnAngleThatIsTakenForTheFlagBesideIt) {
  CopiedTable roll = table_of("k2_roll/roll_days_0_50.csv.gz");
  roll.exchange(1, 2);
  expect_refused("k2_roll", roll, "rows are marked as events");
}

TEST_F(MutilatedRecordings, CurvesOfAModule) {
  const CopiedTable curve = table_of("pv_cracked/module_crack1.csv");
  CopiedTable exchanged = curve, milli = curve, reversed = curve;
  exchanged.exchange(0, 1);
  expect_refused("pv_cracked", exchanged, "look exchanged");
  milli.multiply(1, 1e3);
  expect_refused("pv_cracked", milli, "a column in milliamperes is named current_mA");
  reversed.multiply(1, -1.0);
  expect_found("pv_cracked", reversed, {"cell_cracked"}, "their sign was reversed");
}

}  // namespace
}  // namespace photorque
