// CSV and JSON read back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/errors.h"
#include "core/files.h"
#include "images/writers/product.h"
#include "tests/images/sample_product.h"

namespace photorque {
namespace {

using Row = std::vector<std::string>;

// A reader of RFC 4180 (without line breaks in cells) that skips lines of comment.
std::vector<Row> read_csv(const std::string& text) {
  std::vector<Row> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#')) continue;
    Row row(1);
    bool quoted = false;
    for (size_t i = 0; i < line.size(); ++i) {
      if (quoted && line[i] == '"' && i + 1 < line.size() && line[i + 1] == '"') {
        row.back() += line[i++];
      } else if (line[i] == '"') {
        quoted = !quoted;
      } else if (line[i] == ',' && !quoted) {
        row.emplace_back();
      } else {
        row.back() += line[i];
      }
    }
    rows.push_back(row);
  }
  return rows;
}

class Csv : public FolderTest {
 protected:
  std::vector<Row> rows_of(const Product& product, const std::string& file) const {
    write_formats(product, sample_provenance(), folder, {"csv"});
    return read_csv(read_file(folder / file));
  }
};

TEST_F(Csv, MapReadsBackAtBinCentres) {
  const Map map = sample_map();
  Product product;
  product.maps = {map};
  const std::vector<Row> rows = rows_of(product, "irradiance_plate.csv");
  EXPECT_EQ(rows.at(0), (Row{"x_m", "y_m", "value_W_m2", "standard_error_W_m2"}));
  ASSERT_EQ(rows.size(), 1 + map.value.size());
  for (int iy = 0; iy < map.height; ++iy) {
    for (int ix = 0; ix < map.width; ++ix) {
      const size_t i = static_cast<size_t>(iy) * map.width + ix;
      // Bins of 0.1 m from x = −0.35 m and from y = 0.1 m.
      EXPECT_NEAR(std::stod(rows[i + 1][0]), -0.3 + 0.1 * ix, 1e-15);
      EXPECT_NEAR(std::stod(rows[i + 1][1]), 0.15 + 0.1 * iy, 1e-15);
      EXPECT_EQ(std::stod(rows[i + 1][2]), map.value[i]);
      EXPECT_EQ(std::stod(rows[i + 1][3]), map.standard_error[i]);
    }
  }
}

TEST_F(Csv, TableReadsBackWithAwkwardText) {
  const Product product = sample_product();
  const std::vector<Row> rows = rows_of(product, "budget.csv");
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0], (Row{"effect", "torque_N_m"}));
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(rows[i + 1][0], product.tables[0].columns[0].texts[i]);
  EXPECT_EQ(std::stod(rows[1][1]), 0.1);
  EXPECT_EQ(std::stod(rows[2][1]), 1.0 / 3.0);
  EXPECT_EQ(rows[3][1], "") << "NaN is an empty cell";
}

// Spreadsheets also split the lines of provenance into cells.
TEST_F(Csv, ProvenanceHasNoFormulas) {
  Product product = sample_product();
  product.tables[0].title = "a;@b,-c = d";
  Provenance provenance = sample_provenance();
  provenance.inputs = {{"n,=1+1.toml", "00"}};
  write_formats(product, provenance, folder, {"csv"});
  const std::string text = read_file(folder / "budget.csv");
  EXPECT_THAT(text, testing::HasSubstr("\n# input: n,'=1+1.toml 00\n"));
  EXPECT_THAT(text, testing::HasSubstr("\n# title: a;'@b,'-c = d\n"));
}

TEST_F(Csv, TableWithoutRowsKeepsItsHeader) {
  Product product;
  product.tables = {{"empty", "", {{"t_s", {}, {}}, {"power_W", {}, {}}}}};
  const std::vector<Row> rows = rows_of(product, "empty.csv");
  EXPECT_EQ(rows, (std::vector<Row>{{"t_s", "power_W"}}));
}

TEST(Summary, ReadsBackEqual) {
  const Product product = sample_product();
  const auto json = nlohmann::json::parse(
      summary_json(product, sample_provenance(), {.wall_time_s = 1.25, .rays = 1ull << 60}));
  for (const Quantity& quantity : product.quantities) {
    EXPECT_EQ(json.at(quantity.name).at("value").get<double>(), quantity.estimate.value);
    EXPECT_EQ(json.at(quantity.name).at("standard_error").get<double>(),
              quantity.estimate.standard_error);
  }
  const auto& made_by = json.at("provenance");
  EXPECT_EQ(made_by.at("version"), sample_provenance().version);
  EXPECT_EQ(made_by.at("git_hash"), sample_provenance().git_hash);
  EXPECT_EQ(made_by.at("seed").get<uint64_t>(), sample_provenance().seed);
  EXPECT_EQ(made_by.at("rays").get<uint64_t>(), 1ull << 60);
  EXPECT_EQ(made_by.at("wall_time_s").get<double>(), 1.25);
}

TEST(Summary, ListsTheChecksThatFailed) {
  Provenance provenance = sample_provenance();
  EXPECT_TRUE(nlohmann::json::parse(summary_json({}, provenance)).at("warnings").empty());
  provenance.warnings = {"two routes differ", "power is lost"};
  const auto json = nlohmann::json::parse(summary_json({}, provenance));
  EXPECT_EQ(json.at("warnings"), nlohmann::json(provenance.warnings));
  EXPECT_EQ(json.at("provenance").at("warnings"), nlohmann::json(provenance.warnings));
}

TEST(Summary, WritesNullForNonFiniteNumbers) {
  Product product;
  product.quantities = {{"a_W", {std::nan(""), HUGE_VAL}}};
  const auto json = nlohmann::json::parse(summary_json(product, {}));
  EXPECT_TRUE(json.at("a_W").at("value").is_null());
  EXPECT_TRUE(json.at("a_W").at("standard_error").is_null());
  EXPECT_FALSE(json.at("provenance").contains("wall_time_s"));
}

TEST(Summary, KeepsTheWallTimeOnALineOfItsOwn) {
  const auto without_wall_time = [](double seconds) {
    std::istringstream lines(
        summary_json(sample_product(), sample_provenance(), {.wall_time_s = seconds, .rays = 1}));
    std::string rest;
    for (std::string line; std::getline(lines, line);) {
      if (line.find("wall_time_s") == std::string::npos) rest += line + "\n";
    }
    return rest;
  };
  EXPECT_EQ(without_wall_time(1.0), without_wall_time(2.5));
}

TEST(Summary, RefusesNamesThatHideEachOther) {
  Product product;
  product.quantities = {{"a_W", {}}, {"a_W", {}}};
  EXPECT_THROW(summary_json(product, {}), InputError);
  product.quantities = {{"provenance", {}}};
  EXPECT_THROW(summary_json(product, {}), InputError);
  product.quantities = {{"schema", {}}};
  EXPECT_THROW(summary_json(product, {}), InputError);
}

}  // namespace
}  // namespace photorque
