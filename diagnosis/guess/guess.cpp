#include "diagnosis/guess/guess.h"

#include "core/errors.h"
#include "core/text/parse.h"
#include "diagnosis/light/recordings/recording.h"

namespace photorque {

std::string comment_lines(const std::string& text, size_t width) {
  std::string result, line = "#";
  for (const std::string_view word : words_of(text)) {
    if (line.size() + 1 + word.size() > width && line.size() > 1) {
      result += line + "\n";
      line = "#";
    }
    line += " " + std::string(word);
  }
  return result + line + "\n";
}

std::string guess_experiment(const std::vector<std::filesystem::path>& recordings,
                             const std::filesystem::path& folder) {
  if (recordings.empty()) {
    throw InputError({}, "--guess", "nothing", "a recording (CSV), or several of one machine");
  }
  std::string names;
  for (const std::filesystem::path& path : recordings) {
    names += (names.empty() ? "" : ", ") + path.filename().string();
  }
  const std::string head =
      comment_lines("Made by photorque diagnose --guess from " + names +
                    ". Numbers were read from there; what is assumed says CONFIRM and waits for "
                    "somebody who knows the machine.") +
      "\n";
  if (!is_light_recording(recordings.front())) return head + guess_motion(recordings);
  const LightRecording first = read_light_recording(recordings.front(), {});
  if (first.kind != LightRecording::Kind::sweep) {
    throw InputError({recordings.front().string()}, "header", "a recording of light on a scene",
                     "motion, or current over voltage: a scan or a run needs its scene, which "
                     "photorque new --scene MODEL begins");
  }
  return head + guess_module(recordings, folder);
}

}  // namespace photorque
