#include "tools/commands/page.h"

#include "tools/runs/console.h"

namespace photorque {
namespace {

// As a shell takes it for one word.
std::string quoted(const std::string& word) {
  static constexpr const char* plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=:,+-[]";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos &&
      word.find('[') == std::string::npos) {
    return word;
  }
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

PageHead page_head(const CommandLine& line) {
  std::string command =
      "photorque " + line.verb + " " + quoted(line.experiment.filename().string());
  for (const std::string& change : line.overrides) command += " --set " + quoted(change);
  for (const auto& path : line.recordings)
    command += " --recording " + quoted(path.filename().string());
  for (const auto& path : line.holdouts)
    command += " --holdout " + quoted(path.filename().string());
  if (line.seed) command += " --seed " + std::to_string(*line.seed);
  if (line.target_error) command += " --target-error " + show(*line.target_error);
  if (line.max_time_s) command += " --max-time " + show(*line.max_time_s);
  if (line.allow_outside) command += " --allow-outside";
  return {line.experiment.stem().string(), line.verb, command + " --page"};
}

}  // namespace photorque
