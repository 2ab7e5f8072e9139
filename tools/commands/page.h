// What --page writes on a page about the command itself.
#pragma once

#include "tools/commands/verb.h"
#include "tools/pages/pages.h"

namespace photorque {

// The command without what changes no result: no folder, no number of threads.
PageHead page_head(const CommandLine& line);

}  // namespace photorque
