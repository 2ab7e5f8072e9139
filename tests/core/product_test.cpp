#include "core/product.h"

#include <gtest/gtest.h>

#include "core/errors.h"

namespace photorque {
namespace {

TEST(Table, IsFilledByColumnName) {
  Table table = Table::of("maxima", "Local maxima", {"place", "power_W", "voltage_V"});
  table.row().set("voltage_V", 31.0).set("place", "left").set("power_W", 94.0);
  table.row().set("place", "right").set("power_W", 95.0).set("voltage_V", 17.0);
  ASSERT_EQ(table.columns.size(), 3u);
  EXPECT_EQ(table.columns[0].texts, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(table.columns[1].values, (std::vector<double>{94.0, 95.0}));
  EXPECT_EQ(table.column("voltage_V").values, (std::vector<double>{31.0, 17.0}));
}

TEST(Table, GetsTheColumnsOfItsFirstRow) {
  Table table = Table::of("maxima", "Local maxima");
  table.row().set("place", "left").set("power_W", 94.0);
  EXPECT_THROW(table.row().set("voltage_V", 31.0), NumericalError);
  table.row().set("power_W", 95.0).set("place", "right");
  ASSERT_EQ(table.columns.size(), 2u);
  EXPECT_EQ(table.column("place").texts, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(table.column("power_W").values, (std::vector<double>{94.0, 95.0}));
}

TEST(Table, RejectsTextThatWouldShiftRows) {
  Table table = Table::of("t", "", {"a", "b"});
  EXPECT_THROW(table.row().set("c", 1.0), NumericalError);
  EXPECT_THROW(table.row().set("a", 1.0).set("a", 2.0), NumericalError);
  Table mixed = Table::of("t", "", {"a"});
  mixed.row().set("a", 1.0);
  EXPECT_THROW(mixed.row().set("a", "one"), NumericalError);
  Table left_out = Table::of("t", "", {"a", "b"});
  left_out.row().set("a", 1.0);
  EXPECT_THROW(left_out.row().set("b", 2.0), NumericalError);
}

TEST(Table, RefusesColumnsOfAnotherLengthAndNamesThatAreTaken) {
  Table table = Table::of("t", "");
  table.add("a", std::vector<double>{1.0, 2.0});
  EXPECT_THROW(table.add("b", std::vector<double>{1.0}), NumericalError);
  EXPECT_THROW(table.add("a", std::vector<double>{1.0, 2.0}), NumericalError);
  EXPECT_THROW(static_cast<void>(table.column("b")), NumericalError);
}

}  // namespace
}  // namespace photorque
