#include "tools/program/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string_view>

#include "core/provenance.h"
#include "core/settings/settings.h"
#include "core/text/format.h"

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

// Long name of an option, such as "--set"; the short name if there is no other.
std::string name_of(const CLI::Option& option) {
  return option.get_lnames().empty() ? "-" + option.get_snames().front()
                                     : "--" + option.get_lnames().front();
}

// Placeholder for an option's value: TARGET_ERROR for --target-error.
std::string value_name(const CLI::Option& option) {
  std::string text;
  for (const char c : name_of(option).substr(2)) {
    text += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return text;
}

std::string escaped(const std::string& text, std::string_view special) {
  std::string safe;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) safe += '\\';
    safe += c;
  }
  return safe;
}

// Escapes text for troff: hyphens are printed as hyphens, and no line begins a request.
std::string troff(const std::string& text) {
  return (text.starts_with('.') ? "\\&" : "") + escaped(text, "-\\");
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

std::string words_of(const CLI::App& app) {
  return joined_text(options_of(app), " ",
                     [&](const CLI::Option* option) { return name_of(*option); });
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

// Escapes characters with a meaning in zsh's descriptions of options.
std::string zsh_text(const std::string& text) {
  return escaped(text, ":[]\\");
}

std::string zsh_script(const CLI::App& app) {
  std::string names, cases;
  for (const CLI::App* command : commands_of(app)) {
    names += "    " + shell_word(command->get_name() + ":" + zsh_text(command->get_description())) +
             "\n";
    cases += "    " + command->get_name() + ")\n      _arguments";
    for (const CLI::Option* option : options_of(*command)) {
      cases += " \\\n        " +
               shell_word("*" + name_of(*option) + "[" + zsh_text(option->get_description()) + "]" +
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
            shell_word(command->get_description()) + "\n";
    for (const CLI::Option* option : options_of(*command)) {
      const std::string name = name_of(*option);
      text += "complete -c photorque -n '__fish_seen_subcommand_from " + command->get_name() +
              "' " + (name.starts_with("--") ? "-l " + name.substr(2) : "-s " + name.substr(1)) +
              (takes_value(*option) ? " -r" : "") + " -d " + shell_word(option->get_description()) +
              "\n";
    }
  }
  return text;
}

// Manual page photorque(1) as troff.
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
         ".SH EXIT STATUS\n.TP\n0\nDone.\n.TP\n2\nWrong input: one line with file, line, key, "
         "value "
         "found and value expected.\n.TP\n3\nThe computation failed.\n";
}

// Shell script that completes commands, options and files.
std::string completion_script(const CLI::App& app, const std::string& shell) {
  if (shell == "bash") return bash_script(app);
  return shell == "zsh" ? zsh_script(app) : fish_script(app);
}

// Requested output for packages.
struct Manual {
  bool page = false;
  std::string shell;
};

void add_manual(CLI::App& app, Manual& manual) {
  static const std::vector<std::string> shells = {"bash", "zsh", "fish"};
  app.add_flag("--man", manual.page, "Print the manual page (troff)");
  app.add_option("--completion", manual.shell,
                 "Print the completion script of a shell: bash, zsh or fish")
      ->check(CLI::IsMember(shells));
}

CLI::Option* add_value(CLI::App& app, const Option& option) {
  return std::visit(
      [&](auto* value) {
        if constexpr (std::is_same_v<decltype(value), bool*>) {
          return app.add_flag(option.names, *value, option.help);
        } else {
          return app.add_option(option.names, *value, option.help);
        }
      },
      option.value);
}

void add_option(CLI::App& app, const Option& option) {
  CLI::Option* added = add_value(app, option);
  if (option.is_required) added->required();
  if (option.is_one_each) added->allow_extra_args(false);
  std::visit(
      [&](const auto& range) {
        if constexpr (!std::is_same_v<decltype(range), const std::monostate&>) {
          added->check(CLI::Range(range.first, range.second));
        }
      },
      option.range);
  if (option.mistake) added->check(option.mistake);
}

// Hint for options that must be repeated. They do not accept lists, because a list would swallow an
// experiment that follows it.
std::string hint_at(int argc, char** argv) {
  for (const char* option : {"--recording", "--holdout", "--set"}) {
    if (std::find(argv + 1, argv + argc, std::string_view(option)) == argv + argc) continue;
    return std::string("; repeat ") + option + " before each of several";
  }
  return "";
}

// One line for arguments that the command does not support, with the most similar option.
std::string unexpected(const CLI::ParseError& error, const CLI::App& app, int argc, char** argv) {
  const std::string text = error.what();
  std::istringstream words(text.substr(text.find(": ") + 1));
  std::vector<std::string> found{std::istream_iterator<std::string>(words), {}};
  const auto option =
      std::ranges::find_if(found, [](const std::string& word) { return word.starts_with("-"); });
  if (option == found.end()) {
    return "found " + joined_text(found, " ") + ", expected nothing more" + hint_at(argc, argv);
  }
  std::set<std::string> known;
  for (const CLI::App* verb : app.get_subcommands()) {
    for (const CLI::Option* one : options_of(*verb)) known.insert(name_of(*one));
  }
  const std::string similar = nearest(*option, known);
  return *option + ": found an unknown option, expected " +
         (similar.empty() ? "one that --help lists" : "a known one, perhaps " + similar);
}

// One line for a first word that is not a command; empty if it may be one.
std::string unknown_command(const std::string& word, const std::vector<Verb>& verbs) {
  std::set<std::string> known;
  for (const Verb& verb : verbs) known.insert(verb.name);
  if (word.starts_with('-') || known.contains(word)) return "";
  if (word.ends_with(".toml")) {
    return "found " + word +
           ", expected a command before it: did you forget it? e.g. photorque power " + word;
  }
  const std::string likest = nearest(word, known);
  return "unknown command \"" + word + "\"" +
         (likest.empty() ? "" : ", perhaps \"" + likest + "\"");
}

CommandLine refused(const std::string& mistake, const std::string& verb = "") {
  std::fprintf(stderr, "photorque: %s (see photorque %s--help)\n", clean_text(mistake).c_str(),
               verb.empty() ? "" : (verb + " ").c_str());
  return {2};
}

}  // namespace

CommandLine read_command_line(int argc, char** argv, const std::vector<Verb>& verbs) {
  CLI::App app(
      "Irradiance, solar-array power, radiation torque and attitude of free-floating platforms.");
  app.name("photorque");
  const Provenance build = build_provenance();
  app.set_version_flag("--version", "photorque " + build.version + " (git " + build.git_hash + ")");
  app.require_subcommand(0, 1);
  std::vector<Command> commands;
  for (const Verb& verb : verbs) {
    CLI::App* subcommand = app.add_subcommand(verb.name, verb.summary);
    commands.push_back(verb.command());
    commands.back().options->verb = verb.name;
    for (const Option& option : commands.back().list) add_option(*subcommand, option);
  }
  Manual manual;
  add_manual(app, manual);
  if (argc > 1) {
    const std::string unknown = unknown_command(argv[1], verbs);
    if (!unknown.empty()) return refused(unknown);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return {app.exit(error)};  // --help, --version
    static const std::regex range(R"(Value (\S+) not in range (\S+) to (\S+))");
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError)) {
      return refused(unexpected(error, app, argc, argv));
    }
    if (std::string_view(error.what()) == "experiment is required") {
      return refused("found no experiment, expected one: photorque " + std::string(argv[1]) +
                     " EXPERIMENT.toml");
    }
    return refused(
        std::regex_replace(error.what(), range, "found $1, expected a number from $2 to $3"));
  }
  if (manual.page || !manual.shell.empty()) {
    const std::string text =
        manual.page ? man_page(app, build.version) : completion_script(app, manual.shell);
    std::fputs(text.c_str(), stdout);
    return {0};
  }
  for (size_t i = 0; i < verbs.size(); ++i) {
    if (!app.got_subcommand(verbs[i].name)) continue;
    const std::string mistake = commands[i].mistake ? commands[i].mistake() : "";
    if (!mistake.empty()) return refused(mistake, verbs[i].name);
    return {std::nullopt, &verbs[i], std::move(commands[i])};
  }
  return refused("found no command, expected one such as: photorque power EXPERIMENT.toml");
}

}  // namespace photorque
