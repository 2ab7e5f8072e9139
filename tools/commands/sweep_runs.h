// A command as what the runs of a sweep do.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/product.h"
#include "tools/commands/verb.h"

namespace photorque {

// InputError for a command that gives no figures.
void require_sweepable(const std::string& command);

// The command on the experiment of `line`, silent and without files, under the options of one run;
// gives the figures of its summary.
std::function<std::vector<Quantity>(const RunOptions&)> run_of_verb(const CommandLine& line,
                                                                    const std::string& command);

}  // namespace photorque
