#include "tools/commands/sweep_runs.h"

#include <algorithm>

#include "core/errors.h"
#include "tools/runs/result.h"

namespace photorque {
namespace {

const std::vector<std::string> sweepable = {"trace",   "power",     "torque-map", "budget",
                                            "balance", "propagate", "fit-cell"};

}  // namespace

void require_sweepable(const std::string& command) {
  if (std::ranges::find(sweepable, command) != sweepable.end()) return;
  throw InputError({}, "sweep.verb", '"' + command + '"', "a command that writes a summary: power");
}

std::function<std::vector<Quantity>(const RunOptions&)> run_of_verb(const CommandLine& line,
                                                                    const std::string& command) {
  const std::vector<Verb> verbs = all_verbs();
  const Verb verb = *std::ranges::find(verbs, command, &Verb::name);
  return [line, verb](const RunOptions& options) {
    CommandLine one = line;
    static_cast<RunOptions&>(one) = options;
    one.verb = verb.name;
    one.quiet = true;
    one.json = false;
    std::vector<Quantity> figures;
    one.take_result = [&figures](const RunResult& result) { figures = result.product.quantities; };
    verb.run(one);
    return figures;
  };
}

}  // namespace photorque
