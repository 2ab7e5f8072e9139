// TOML documents that the program writes read back as equal values.
#include "scenes/experiment/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <set>

#include "core/files.h"
#include "scenes/experiment/toml.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

SettingsNode::Table& table_of(SettingsNode& node) {
  return std::get<SettingsNode::Table>(node.value);
}

// Quotes, line ends, every control character, comments, headers, separators, long texts.
std::vector<std::string> hostile_texts() {
  std::vector<std::string> all = {"",
                                  "wall\"\n[evil]\nx = \"1",
                                  "'''\"\"\"",
                                  "a\\",
                                  "\\u0041",
                                  "# no comment",
                                  "[[source]]",
                                  "a.b = 1",
                                  "tab\tand\r\nend",
                                  "\x1b]0;title\x07",
                                  "\u0085\u009b\u2028\ufeff",
                                  "α⊙\U0001F600",
                                  "inf",
                                  "1e9",
                                  "2026-11-27",
                                  " ",
                                  std::string(5000, '"'),
                                  std::string("nul\0here", 8)};
  for (char c = 0; c < 0x20; ++c) all.push_back(std::string("x") + c + "y");
  all.emplace_back("x\x7fy");
  return all;
}

TEST(Document, TextsAndKeysOfAnyContentReadBack) {
  TomlDocument document;
  SettingsNode::Table& table = document.table("names");
  size_t number = 0;
  for (const std::string& text : hostile_texts()) {
    document.comment(text);
    document.set(table, "text" + std::to_string(number++), {text}, text);
    table[text] = {text};
    document.table("root " + text);
    document.add_to_head(text);
    document.set(document.append("[part] " + text), "name", {text});
  }
  const SettingsNode back = parse_toml(document.text(), "back.toml");
  EXPECT_TRUE(same_values(back, document.root));
  EXPECT_EQ(std::get<SettingsNode::Table>(back.value).size(), 1 + 2 * hostile_texts().size());
}

// Such names cannot be read from TOML either: the best that can be done is to keep the document.
TEST(Document, BytesThatAreNotUtf8BecomeTheReplacementCharacter) {
  EXPECT_EQ(toml_value({"caf\xe9 \xc0\xaf\xff"}), "\"caf\uFFFD \uFFFD\uFFFD\uFFFD\"");
  TomlDocument document;
  document.set(document.table("a"), "b", {"\xff"});
  EXPECT_NO_THROW(document.text());
}

TEST(Document, NumbersReadBackToTheBit) {
  using limits = std::numeric_limits<double>;
  using whole = std::numeric_limits<int64_t>;
  TomlDocument document;
  SettingsNode::Array numbers;
  for (const double x : {0.0, -0.0, 0.1, 1e300, -1e300, limits::min(), limits::denorm_min(),
                         -limits::denorm_min(), limits::max(), limits::infinity(),
                         -limits::infinity(), limits::quiet_NaN(), 4294967296.0, 1e15, 1e17}) {
    numbers.push_back({x});
  }
  for (const int64_t n : {int64_t{0}, whole::max(), whole::min()}) numbers.push_back({n});
  table_of(document.root)["x"] = {numbers};
  EXPECT_TRUE(same_values(parse_toml(document.text(), "back.toml"), document.root));
}

// By sections, dotted keys, inline tables, texts and arrays over several lines.
constexpr const char* written = R"(#:schema ../experiment.schema.json
# My laboratory.
title = """
two "quoted" lines
"""   # a title
platform.mass_kg = 8.7   # weighed twice
platform.body.colour = 'red'

# Two lamps.
[[source]]
name = "lamp \"A\""   # not # this
aim.node = "plate"
size_m = { value = [0.1,   # across
  0.2], sigma = [1e-3, 2e-3] }
# The second.
[[source]]
power_mW = 4000
[[source.led]]
index = 1
[array]   # of cells
cells = [
  # rows
  [1, 2],
  [3, 4],
]
[array.loss]
ohmic = true
[environment.igrf]
date = 2026-11-27
# The end.
)";

TEST(Document, KeepsValuesOrderAndCommentsOfAText) {
  const TomlDocument document(written, "lab.toml");
  const std::string text = document.text();
  EXPECT_TRUE(same_values(parse_toml(text, "again.toml"), parse_toml(written, "lab.toml")));
  EXPECT_EQ(TomlDocument(text, "again.toml").text(), text);
  EXPECT_THAT(text, Not(HasSubstr("#:schema")));
  for (const char* kept :
       {"# My laboratory.\n# a title\ntitle = \"two \\\"quoted\\\" lines\\n\"\n",
        "mass_kg = 8.7  # weighed twice\n",
        "\n# Two lamps.\n[[source]]\nname = \"lamp \\\"A\\\"\"  # not # this\n", "# across\n",
        "\n# The second.\n[[source]]\npower_mW = 4000\n", "[array]  # of cells\n",
        "# rows\ncells = [[1, 2], [3, 4]]\n", "\n# The end.\n"}) {
    EXPECT_THAT(text, HasSubstr(kept));
  }
  EXPECT_LT(text.find("[platform"), text.find("[[source]]"));
  EXPECT_LT(text.find("[[source]]"), text.find("[array]"));
}

TEST(Document, AddsAndReplacesKeys) {
  TomlDocument document(
      "[disturbance]\nkind = \"tether\"  # one\n[platform]\nmass_kg = 8  # weighed\nx = 1\n",
      "lab.toml");
  document.comment("found");
  document.set(document.append("disturbance"), "kind", {"dipole"}, "sure");
  document.comment("before: 8");
  document.replace(document.table("platform"), "mass_kg", "mass_g", {int64_t{8100}});
  EXPECT_EQ(document.text(),
            "[[disturbance]]\nkind = \"tether\"  # one\n\n# found\n[[disturbance]]\n"
            "kind = \"dipole\"  # sure\n\n[platform]\n# before: 8\nmass_g = 8100  # weighed\n"
            "x = 1\n");
}

TEST(Document, RefusesATableWhereAValueStands) {
  TomlDocument document("platform = 3\nsource = 4\n", "lab.toml");
  EXPECT_THROW(document.table("platform"), InputError);
  EXPECT_THROW(document.append("source"), InputError);
}

// Whatever is shipped, and the tests' example of every key.
TEST(Document, EveryShippedExperimentReadsBackAsItself) {
  size_t count = 0;
  for (const char* folder : {"scenes", "docs", "tests/data", "validation"}) {
    for (const auto& entry :
         fs::recursive_directory_iterator(fs::path(PHOTORQUE_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".toml") continue;
      const std::string text = read_file(entry.path()), name = entry.path().string();
      const TomlDocument document(text, name);
      SettingsNode back;
      ASSERT_NO_THROW(back = parse_toml(document.text(), name)) << name;
      EXPECT_TRUE(same_values(back, parse_toml(text, name))) << name;
      // Comments stay, but for that of the schema.
      const auto comments = [](const std::string& of) {
        std::multiset<std::string> all;
        for (const TomlComment& comment : toml_comments(of)) {
          if (!comment.text.starts_with("#:schema")) all.insert(comment.text);
        }
        return all;
      };
      EXPECT_EQ(comments(document.text()), comments(text)) << name;
      ++count;
    }
  }
  EXPECT_GE(count, 20u);
}

}  // namespace
}  // namespace photorque
