#include "tools/manual/pages.h"

namespace photorque {
namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return !option->get_positional(); });
}

bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

// "--set", or the short name where there is no other.
std::string name_of(const CLI::Option& option) {
  return option.get_lnames().empty() ? "-" + option.get_snames().front()
                                     : "--" + option.get_lnames().front();
}

// What stands for an option's value: that of --target-error is TARGET_ERROR.
std::string value_name(const CLI::Option& option) {
  std::string text;
  for (const char c : name_of(option).substr(2)) {
    text += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return text;
}

// Hyphens are printed as such, and no line begins a request.
std::string troff(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '-' || c == '\\') safe += '\\';
    safe += c;
  }
  return safe.starts_with('.') ? "\\&" + safe : safe;
}

std::string troff_options(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : options_of(app)) {
    text += ".TP\n\\fB" + troff(name_of(*option)) + "\\fR";
    if (takes_value(*option)) text += " \\fI" + troff(value_name(*option)) + "\\fR";
    text += "\n" + troff(option->get_description()) + "\n";
  }
  return text;
}

// In single quotes of a shell.
std::string in_quotes(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) safe += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return safe + "'";
}

std::string words_of(const CLI::App& app) {
  std::string words;
  for (const CLI::Option* option : options_of(app))
    words += (words.empty() ? "" : " ") + name_of(*option);
  return words;
}

std::string bash_script(const CLI::App& app) {
  std::string cases, names;
  for (const CLI::App* command : commands_of(app)) {
    names += (names.empty() ? "" : " ") + command->get_name();
    cases += "    " + command->get_name() + ") words=\"" + words_of(*command) + "\" ;;\n";
  }
  return "# bash completion of photorque\n"
         "_photorque() {\n"
         "  local word=\"${COMP_WORDS[COMP_CWORD]}\" words\n"
         "  if [[ $COMP_CWORD -eq 1 ]]; then\n"
         "    mapfile -t COMPREPLY < <(compgen -W \"" +
         names + " " + words_of(app) +
         "\" -- \"$word\")\n"
         "    return\n"
         "  fi\n"
         "  case \"${COMP_WORDS[1]}\" in\n" +
         cases +
         "    *) return ;;\n"
         "  esac\n"
         "  if [[ $word == -* ]]; then\n"
         "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
         "  fi\n"
         "}\n"
         "complete -o default -F _photorque photorque\n";
}

// Colons and brackets have a meaning in what zsh describes options by.
std::string zsh_text(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == ':' || c == '[' || c == ']' || c == '\\') safe += '\\';
    safe += c;
  }
  return safe;
}

std::string zsh_script(const CLI::App& app) {
  std::string names, cases;
  for (const CLI::App* command : commands_of(app)) {
    names +=
        "    " + in_quotes(command->get_name() + ":" + zsh_text(command->get_description())) + "\n";
    cases += "    " + command->get_name() + ")\n      _arguments";
    for (const CLI::Option* option : options_of(*command)) {
      cases += " \\\n        " +
               in_quotes("*" + name_of(*option) + "[" + zsh_text(option->get_description()) + "]" +
                         (takes_value(*option) ? ":" + value_name(*option) + ":_files" : ""));
    }
    cases += " \\\n        '*:file:_files' ;;\n";
  }
  return "#compdef photorque\n"
         "_photorque() {\n"
         "  local -a commands=(\n" +
         names +
         "  )\n"
         "  if (( CURRENT == 2 )); then\n"
         "    _describe command commands\n"
         "    return\n"
         "  fi\n"
         "  local command=$words[2]\n"
         "  shift words\n"
         "  (( CURRENT-- ))\n"
         "  case $command in\n" +
         cases +
         "  esac\n"
         "}\n"
         "_photorque \"$@\"\n";
}

std::string fish_script(const CLI::App& app) {
  std::string text = "# fish completion of photorque\n";
  for (const CLI::App* command : commands_of(app)) {
    text += "complete -c photorque -n __fish_use_subcommand -f -a " + command->get_name() + " -d " +
            in_quotes(command->get_description()) + "\n";
    for (const CLI::Option* option : options_of(*command)) {
      const std::string name = name_of(*option);
      text += "complete -c photorque -n '__fish_seen_subcommand_from " + command->get_name() +
              "' " + (name.starts_with("--") ? "-l " + name.substr(2) : "-s " + name.substr(1)) +
              (takes_value(*option) ? " -r" : "") + " -d " + in_quotes(option->get_description()) +
              "\n";
    }
  }
  return text;
}

}  // namespace

std::string man_page(const CLI::App& app, const std::string& version) {
  std::string text = ".TH PHOTORQUE 1 \"\" \"photorque " + troff(version) +
                     "\" \"User Commands\"\n.SH NAME\nphotorque \\- " +
                     troff(app.get_description()) +
                     "\n.SH SYNOPSIS\n.B photorque\n\\fICOMMAND\\fR \\fIEXPERIMENT\\fR "
                     "[\\fIOPTION\\fR]...\n.SH OPTIONS\n" +
                     troff_options(app) + ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(app)) {
    text += ".SS " + troff(command->get_name()) + "\n" + troff(command->get_description()) + ".\n" +
            troff_options(*command);
  }
  return text +
         ".SH EXIT STATUS\n.TP\n0\nDone.\n.TP\n2\nWrong input: one line with file, line, key, what "
         "was found and what was expected.\n.TP\n3\nThe computation failed.\n";
}

std::string completion_script(const CLI::App& app, const std::string& shell) {
  if (shell == "bash") return bash_script(app);
  return shell == "zsh" ? zsh_script(app) : fish_script(app);
}

}  // namespace photorque
