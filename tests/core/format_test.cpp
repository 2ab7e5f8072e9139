#include <gtest/gtest.h>
#include <random>

#include "core/text/format.h"

namespace photorque {
namespace {

// Cases of M. Kuhn's UTF-8 decoder stress test: stray continuation, truncated sequence, overlong
// forms, surrogate, beyond U+10FFFF, impossible byte.
TEST(CleanText, ReplacesInvalidUtf8) {
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

TEST(ShellWord, IsOneWordOnOneLine) {
  EXPECT_EQ(shell_word("a/b.csv"), "a/b.csv");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word("a\n[evil]\\'"), "$'a\\012[evil]\\\\\\''");
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

TEST(ColumnName, FollowsTheContract) {
  EXPECT_EQ(column_name("x [m]"), "x_m");
  EXPECT_EQ(column_name("W/m²"), "W_m2");
  EXPECT_EQ(column_name("N·m"), "N_m");
  EXPECT_EQ(column_name("tilt [°]"), "tilt_deg");
  EXPECT_EQ(column_name(""), "");
}

std::string encoded(std::string_view text) {
  return base64(std::as_bytes(std::span(text.data(), text.size())));
}

// RFC 4648, section 10.
TEST(Base64, EncodesTheVectorsOfTheStandard) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xfb\xff\xbe"), "+/++");
}

}  // namespace

}  // namespace photorque
