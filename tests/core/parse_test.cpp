// Lines, cells, words and numbers of text files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/files.h"
#include "core/text/parse.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Text, LinesEndAsAnySystemEndsThem) {
  EXPECT_THAT(lines_of("a\nb\r\nc\rd"), ElementsAre("a", "b", "c", "d"));
  EXPECT_THAT(lines_of("a\n\nb\n"), ElementsAre("a", "", "b"));
  EXPECT_THAT(lines_of(""), ElementsAre());
}

TEST(Text, TrimmedLosesBlanksAndUnquotedQuotesToo) {
  EXPECT_EQ(trimmed(" \t\r\v\fa b\x1a\n"), "a b");
  EXPECT_EQ(trimmed("\"a\""), "\"a\"");
  EXPECT_EQ(unquoted(" \"a b\" "), "a b");
  EXPECT_EQ(trimmed(" \t"), "");
}

TEST(Text, CellsAreOneMoreThanSeparators) {
  EXPECT_THAT(cells_of("a, \"b\" ,,c"), ElementsAre("a", "b", "", "c"));
  EXPECT_THAT(cells_of("a;b;", ';'), ElementsAre("a", "b", ""));
  EXPECT_THAT(cells_of(""), ElementsAre(""));
}

TEST(Text, NamesBetweenBlanksKeepTheirUnits) {
  EXPECT_THAT(names_between_blanks("Time (s)  U / V I in A \"T [deg C]\" x"),
              ElementsAre("Time (s)", "U / V", "I in A", "T [deg C]", "x"));
}

TEST(Text, WordsAreNeverEmpty) {
  EXPECT_THAT(words_of("  a\tb  c "), ElementsAre("a", "b", "c"));
  EXPECT_THAT(words_of("(1, 2,3)", " (),"), ElementsAre("1", "2", "3"));
  EXPECT_THAT(words_of(" "), ElementsAre());
}

TEST(Text, DataLinesSkipCommentsAndHaveLineNumbers) {
  DataLines lines("# one\n\n  a \r\n# four\nb", "f.csv");
  std::string_view line;
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line, "a");
  EXPECT_EQ(lines.where().line, 3);
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line, "b");
  EXPECT_EQ(lines.where().line, 5);
  EXPECT_FALSE(lines.next(line));
}

TEST(Text, DataLinesPassOverAByteOrderMark) {
  DataLines lines("\xef\xbb\xbfincidence_deg,brdf_1_sr\n", "f.csv");
  std::string_view line;
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(line, "incidence_deg,brdf_1_sr");
}

TEST(Text, NumbersAreWholeAndFinite) {
  EXPECT_EQ(number_in("-2.5e3"), -2500.0);
  EXPECT_EQ(number_in("+1"), 1.0);
  for (const char* wrong : {"", " 1", "1 ", "1,5", "nan", "inf", "1e999", "+-1", "++1", "0x1p3"}) {
    EXPECT_FALSE(number_in(wrong).has_value()) << wrong;
  }
  for (const double x : {0.1, 1.0 / 3.0, 5e-324, -1.7976931348623157e308}) {
    EXPECT_EQ(number_in(shortest(x)), x);
  }
}

TEST(Text, AWrongNumberIsReportedWithPlaceKeyAndRange) {
  EXPECT_EQ(refusal_of([&] {
              require_number(std::string(60, 'x'), {"lamp.ies", 7}, "watts");
            }),
            "lamp.ies:7: watts: found \"" + std::string(40, 'x') + "…\", expected a number");
}

TEST(Text, CountsAreWholeAndInRange) {
  EXPECT_EQ(require_count(3.0, {}, "lamps", 1, 3), 3u);
  for (const double wrong : {0.0, 4.0, 2.5, -1.0, std::nan("")}) {
    EXPECT_THROW(require_count(wrong, {}, "lamps", 1, 3), InputError) << wrong;
  }
}

TEST(Columns, AreFoundByNameAndWrongCellsByLine) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "text_test.csv";
  write_file_whole(path, std::string("# made by hand\nb,\"a\",c\n1, 2 ,x\n\n3,4\n"));
  const NumberColumns read = read_number_columns(path, {"a", "b"});
  EXPECT_THAT(read.header, ElementsAre("b", "a", "c"));
  EXPECT_THAT(read.columns[0], ElementsAre(2.0, 4.0));
  EXPECT_THAT(read.columns[1], ElementsAre(1.0, 3.0));
  EXPECT_THAT(read.lines, ElementsAre(3, 5));
  const auto message = [&](const std::string& name) {
    return refusal_of([&] { read_number_columns(path, {name}); });
  };
  EXPECT_THAT(message("c"), HasSubstr("text_test.csv:3: c: found \"x\", expected a finite number"));
  EXPECT_THAT(message("d"), HasSubstr("text_test.csv:2: header: found the columns "));
  // Decimal commas: once the numbers after them were read in the wrong columns.
  write_file_whole(path, std::string("a,c\n1,2\n0,5,7\n"));
  EXPECT_THAT(message("c"), HasSubstr("text_test.csv:3: found a row of 3 cells, expected 2"));
  // Where semicolons or tabs separate, a comma is a decimal comma.
  for (const std::string text : {"a;b\n1,5;2\n", "a\tb\n1.5\t2\n"}) {
    write_file_whole(path, text);
    const NumberColumns other = read_number_columns(path, {"b", "a"});
    EXPECT_THAT(other.columns[0], ElementsAre(2.0));
    EXPECT_THAT(other.columns[1], ElementsAre(1.5));
  }
  std::filesystem::remove(path);
}

TEST(Text, SixteenBitTextAndBytesAreDistinguished) {
  const auto message = [](std::string_view begin) -> std::string {
    return refusal_of([&] { require_text(begin, {"r.csv", 1}); });
  };
  using namespace std::string_literals;
  EXPECT_THAT(message("\xff\xfet\0_\0s\0"s), testing::HasSubstr("found UTF-16 text"));
  EXPECT_THAT(message("t\0_\0s\0,\0"s), testing::HasSubstr("found UTF-16 text"));
  // The beginning of HDF5.
  EXPECT_THAT(message("\x89HDF\r\n\x1a\n\0\0\0\0\0\b\b\0\x04\0\x10\0\0\0\0\0\0\0\0\0\0\0\0\0"s),
              testing::HasSubstr("found bytes that are no text"));
  EXPECT_THAT(message("glTF\2\0 and more text"s),
              testing::HasSubstr("found bytes that are no text"));
  EXPECT_EQ(message("\xef\xbb\xbft_s,Ω\n1,2\n"), "");
  EXPECT_EQ(message(""), "");
}

TEST(Text, BracketsOfJsonAreCountedOutsideOfItsStrings) {
  EXPECT_EQ(extent_of_json(R"({"a": [1, [2]], "b": {}})").depth, 3);
  EXPECT_EQ(extent_of_json(R"(["[[[\"[[", "\\"])").depth, 1);
  EXPECT_EQ(extent_of_json("").depth, 0);
  EXPECT_EQ(extent_of_json("[][][]").depth, 1);
  EXPECT_GE(extent_of_json(R"([1, 2, {"a": 3}])").values, 4u);
}

// RFC 3986 section 2.1: a percent sign and two hexadecimal digits, of either case.
TEST(PercentEncoding, EscapesAreTwoHexadecimalDigits) {
  EXPECT_EQ(percent_decoded("a%20b+c%2B%c3%A4"), "a b+c+\xc3\xa4");
  EXPECT_EQ(percent_decoded(""), "");
  for (const char* malformed : {"%", "a%2", "%zz", "%+f", "% f", "%-1", "%0x1", "%%20"}) {
    EXPECT_EQ(percent_decoded(malformed), std::nullopt) << malformed;
  }
}

}  // namespace
}  // namespace photorque
