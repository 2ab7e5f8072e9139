// The example of docs/contributing.md: a verb needs one file and one word in a list.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/program/command_line.h"

namespace photorque {
namespace {

const std::filesystem::path root = PHOTORQUE_SOURCE_DIR;

TEST(AddedVerb, IsReadWithItsOptionAndRun) {
  const std::vector<Verb> verbs = all_verbs();
  ASSERT_EQ(verbs.size(), 1u);
  std::vector<std::string> words = {"photorque", "count",
                                    (root / "scenes/tabletop/tabletop.toml").string(), "--parts"};
  std::vector<char*> line;
  for (std::string& word : words) line.push_back(word.data());
  const CommandLine read = read_command_line(static_cast<int>(line.size()), line.data(), verbs);
  ASSERT_FALSE(read.status);
  EXPECT_EQ(read.verb->name, "count");
  testing::internal::CaptureStdout();
  read.command.run({verbs, nullptr});
  const std::string text = testing::internal::GetCapturedStdout();
  EXPECT_THAT(text, testing::HasSubstr(" triangles\n"));
  EXPECT_GT(std::count(text.begin(), text.end(), '\n'), 2);
}

}  // namespace
}  // namespace photorque
