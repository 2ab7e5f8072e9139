// photorque check: everything about an experiment that can be known without running it.
#include "tools/tasks/check.h"

#include <cstdio>

#include "tools/commands/terminal.h"

namespace photorque::kinds::check {
namespace {

void run_check(const CommandLine& line) {
  const Console console = terminal(line);
  const CheckReport report = check_experiment(line);
  for (const CheckReport::Command& command : report.commands) {
    std::string tables;
    for (const std::string& table : command.tables) tables += " [" + table + "]";
    console.line(padded(command.name, 12) + command.what);
    console.line(padded("", 12) + "reads" + tables);
  }
  for (const auto& [tables, verbs] : report.lacking) {
    std::string names;
    for (const std::string& verb : verbs) names += (names.empty() ? "" : ", ") + verb;
    console.line("not " + names + ": without " + tables);
  }
  for (const std::string& note : report.notes) console.line("note: " + note);
  if (report.mistakes.empty()) return;
  for (size_t i = 0; i + 1 < report.mistakes.size(); ++i) {
    std::fprintf(stderr, "%s\n", report.mistakes[i].what());
  }
  throw InputError(report.mistakes.back());
}

}  // namespace

Verb kind() {
  Verb verb{"check", "What is wrong with an experiment, and what every command would do with it",
            run_check};
  verb.writes = false;
  return verb;
}

}  // namespace photorque::kinds::check
