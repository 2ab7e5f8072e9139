// What other programs read of the command line: the manual page and completions for shells, from
// the same options as --help.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace photorque {

// photorque(1) as troff.
std::string man_page(const CLI::App& app, const std::string& version);

inline const std::vector<std::string> completion_shells = {"bash", "zsh", "fish"};

// A script that completes commands, options and files. `shell` is one of those above.
std::string completion_script(const CLI::App& app, const std::string& shell);

}  // namespace photorque
