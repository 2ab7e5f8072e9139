#include "images/drawing/page_layout.h"

#include <gtest/gtest.h>

#include <random>

#include "core/text/format.h"

namespace photorque {
namespace {

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
