#include "images/drawing/text.h"

#include <gtest/gtest.h>

#include <random>

#include "images/drawing/page_layout.h"

namespace photorque {
namespace {

// Cases of M. Kuhn's UTF-8 decoder stress test: stray continuation, truncated sequence, overlong
// forms, surrogate, beyond U+10FFFF, impossible byte.
TEST(CleanText, ReplacesWhatIsNotUtf8) {
  EXPECT_EQ(clean_text("W/m² × 10⁻⁹ 𝛕"), "W/m² × 10⁻⁹ 𝛕");
  EXPECT_EQ(clean_text("a\x80z"), "a\uFFFDz");
  EXPECT_EQ(clean_text("a\xE2\x82"), "a\uFFFD\uFFFD");
  EXPECT_EQ(clean_text("\xC0\xAF"), "\uFFFD\uFFFD");
  EXPECT_EQ(clean_text("\xE0\x80\xAF"), "\uFFFD\uFFFD\uFFFD");
  EXPECT_EQ(clean_text("\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD");
  EXPECT_EQ(clean_text("\xF4\x90\x80\x80"), "\uFFFD\uFFFD\uFFFD\uFFFD");
  EXPECT_EQ(clean_text("\xFE"), "\uFFFD");
  EXPECT_EQ(clean_text("two\nlines\t"), "two lines ");
}

TEST(XmlText, EscapesMarkup) {
  EXPECT_EQ(xml_text("a<b & \"c\">"), "a&lt;b &amp; &quot;c&quot;&gt;");
}

TEST(RoundTripNumber, ReadsBackAsTheSameDouble) {
  std::mt19937_64 generator(3);
  for (int i = 0; i < 20000; ++i) {
    const double value = std::bit_cast<double>(generator());
    if (!std::isfinite(value)) continue;
    EXPECT_EQ(std::strtod(round_trip_number(value).c_str(), nullptr), value);
  }
  EXPECT_EQ(round_trip_number(0.1), "0.1");
  EXPECT_EQ(round_trip_number(-0.0), "0");
  EXPECT_EQ(round_trip_number(std::nan("")), "");
}

TEST(ReadableNumber, WritesPowersForPeople) {
  EXPECT_EQ(readable_number(0.0), "0");
  EXPECT_EQ(readable_number(812.34), "812.3");
  EXPECT_EQ(readable_number(-1.127e-9), "−1.127×10⁻⁹");
  EXPECT_EQ(readable_number(99999.7), "1.000×10⁵");
  EXPECT_EQ(readable_number(12345.0), "12345");
  EXPECT_EQ(readable_number(0.0123, 2), "0.012");
  EXPECT_EQ(readable_number(std::nan("")), "–");
  EXPECT_EQ(power_of_ten(12), "10¹²");
}

TEST(ColumnName, IsWhatTheContractAsks) {
  EXPECT_EQ(column_name("x [m]"), "x_m");
  EXPECT_EQ(column_name("W/m²"), "W_m2");
  EXPECT_EQ(column_name("N·m"), "N_m");
  EXPECT_EQ(column_name("tilt [°]"), "tilt_deg");
  EXPECT_EQ(column_name(""), "");
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line;
  std::erase(text, ' ');
  return text;
}

TEST(FittedText, NeverIsWiderThanItsRoom) {
  std::mt19937 generator(11);
  for (int i = 0; i < 300; ++i) {
    std::string text;
    for (unsigned n = generator() % 60; n > 0; --n) text += generator() % 6 == 0 ? " " : "µé";
    const double width = 40.0 + generator() % 200;
    const TextBlock block = fitted_text(text, width, {.size = 14.0}, 9.0, 3);
    EXPECT_LE(block.lines.size(), 3u);
    for (const std::string& line : block.lines) {
      EXPECT_LE(text_width(line, block.style), width + 1e-9) << line;
      EXPECT_EQ(clean_text(line), line) << "a character was cut in two";
    }
    const bool shortened = block.lines.back().ends_with("…");
    EXPECT_TRUE(shortened || joined(block.lines) == joined({text}));
  }
}

TEST(FittedText, ShrinksBeforeItShortens) {
  const std::string text = "Irradiance on the solar array of the platform";
  const TextStyle style{.size = 15.0};
  const double exact = text_width(text, style);
  EXPECT_EQ(fitted_text(text, exact, style, 8.0, 1).style.size, 15.0);
  const TextBlock smaller = fitted_text(text, 0.7 * exact, style, 8.0, 1);
  EXPECT_LT(smaller.style.size, 15.0);
  EXPECT_EQ(smaller.lines, std::vector<std::string>{text});
  EXPECT_TRUE(fitted_text(text, 0.3 * exact, style, 8.0, 1).lines[0].ends_with("…"));
}

}  // namespace
}  // namespace photorque
