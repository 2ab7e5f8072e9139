#include "tools/commands/results.h"

#include <cstdio>

namespace photorque {

void write_results(const CommandLine& line, const Console& console, const RunResult& result) {
  const auto folder = line.out_folder();
  if (line.take_result) {
    check_figures(result);
    line.take_result(result);
    return;
  }
  const auto paths = write_run(result, folder, line.verb);
  if (line.json) std::fputs(result.summary().c_str(), stdout);
  console.heading("Written to " + folder.string());
  console.line("  summary.json and " + std::to_string(paths.size()) + " more files; pictures:");
  for (const auto& path : paths) {
    if (path.extension() == ".png") console.line("  " + path.filename().string());
  }
  for (const RunFile& file : result.files) {
    console.line("  " + file.name + (file.remark.empty() ? "" : ": " + file.remark));
  }
}

}  // namespace photorque
