// A command of the program: its options as data, and the function that runs with them. Each command
// is one file. tools/program parses the options and prints help and manual.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

class CheckpointFile;  // tools/coupling/couple.h
class Interruption;    // tools/runs/output_folder.h
struct PageHead;       // tools/pages/pages.h
struct Verb;

// Options of every command line: photorque VERB EXPERIMENT [--set KEY=VALUE …] [--out DIR] …
struct CommandOptions : RunOptions {
  std::string verb;                          // set by the program
  std::string name;                          // name of the results; empty: that of the experiment
  std::optional<std::filesystem::path> out;  // --out
  bool quiet = false;                        // only errors are printed
  bool json = false;                         // the summary as JSON on standard output
  bool verbose = false;                      // all lines on the terminal
  std::string format;                        // additional formats of the results: "exr,svg"
  std::string style = "page";                // of pictures
  bool page = false;                         // --page, if the command has it
  std::optional<double> checkpoint_min;      // --checkpoint, if the command has it

  // --out, or out/NAME/VERB below the current folder.
  std::filesystem::path out_folder() const;
};

// Properties of the program that a command uses.
struct Program {
  const std::vector<Verb>& verbs;
  Interruption* interruption;  // null: a signal leaves incomplete files
};

// One option: the variable for its value, and its line in --help. Options are "--page" or
// "-o,--out"; a name without hyphens is a positional argument.
struct Option {
  std::string names;
  std::variant<bool*, int*, std::string*, std::filesystem::path*,
               std::optional<std::filesystem::path>*, std::optional<double>*,
               std::optional<uint64_t>*, std::vector<std::string>*,
               std::vector<std::filesystem::path>*>
      value;
  std::string help;
  bool is_required = false;
  bool is_one_each = false;  // of lists: the option precedes every item
  template <class Number>
  using Between = std::pair<Number, Number>;
  std::variant<std::monostate, Between<int>, Between<int64_t>, Between<double>> range = {};
  // Returns the mistake in a value as a sentence; empty if there is none.
  std::function<std::string(const std::string&)> mistake = {};
};

// A verb with options that can be parsed, then run.
struct Command {
  enum class Folder { none, own, shared };  // output folder: none, of one run, or shared by several

  std::shared_ptr<CommandOptions> options;
  std::vector<Option> list = {};
  Folder folder = Folder::none;
  // Returns the mistake in a combination of options as a sentence; empty if there is none.
  std::function<std::string()> mistake = {};
  std::function<void(const Program&)> run = {};

  // --threads, --seed, --max-memory, --quiet, --json, --verbose.
  void add_common(CommandOptions& common);
  // --out, --format and --style.
  void add_results(CommandOptions& common);
  // The experiment with --set, the options of results, and the common options.
  void add_experiment(CommandOptions& common, Folder writes = Folder::own, bool required = true);
  // In addition the options of a trace: --target-error, --max-time, --allow-outside.
  void add_traced_experiment(CommandOptions& common, Folder writes = Folder::own);
  void add_recordings(std::vector<std::filesystem::path>& recordings);
  void add_page(CommandOptions& common);
  void add_checkpoint(CommandOptions& common);
  template <class Value>
  Option& add(std::string names, Value& value, std::string help) {
    return list.emplace_back(Option{std::move(names), &value, std::move(help)});
  }
};

struct Verb {
  std::string name;
  std::string summary;  // one sentence for --help
  std::function<Command()> command;
  // Tables of an experiment that the command reads, and a description of those that it requires.
  std::vector<std::string> tables = {};
  std::string needs = {};
  // Computes one design of a sweep, without text and files. Empty if the command has no figures.
  std::function<RunResult(const RunOptions&)> study = {};
};

// A command with its own options, which extend CommandOptions.
template <class Options>
std::function<Command()> command_with(void (*add_options)(Command&, Options&),
                                      void (*run)(const Options&, const Program&)) {
  return [=] {
    const auto options = std::make_shared<Options>();
    Command command;
    command.options = options;
    add_options(command, *options);
    command.run = [options, run](const Program& program) { run(*options, program); };
    return command;
  };
}

// Options of an experiment; of a traced experiment; of one that can also write a page.
void experiment_options(Command& command, CommandOptions& options);
void traced_options(Command& command, CommandOptions& options);
void traced_page_options(Command& command, CommandOptions& options);

// All verbs listed in tools/CMakeLists.txt, in that order.
std::vector<Verb> all_verbs();

// Text on standard output. Without --verbose, long sections are shortened after the first 23 lines;
// headings, their first lines and warnings are always printed. Silent with --quiet and --json.
// Progress is a bar if standard error is a terminal, otherwise a line at most every ten seconds.
Console terminal(const CommandOptions& options);

// Formats and style of --format and --style. Throws InputError for an unknown format.
RunFormats formats_of(const CommandOptions& options);

// Writes the results and summary.json into the output folder (write_run) and prints its name. With
// --json, prints the summary.
void write_results(const CommandOptions& options, const Console& console, const RunResult& result);

// A command that writes the result of `run(options, console)`.
template <class Options, class Run>
std::function<Command()> command_that_writes(void (*add_options)(Command&, Options&), Run run) {
  return [=] {
    const auto options = std::make_shared<Options>();
    Command command{options};
    add_options(command, *options);
    command.run = [options, run](const Program&) {
      const Console console = terminal(*options);
      write_results(*options, console, run(*options, console));
    };
    return command;
  };
}

// The file of --checkpoint; null without the option.
std::unique_ptr<CheckpointFile> checkpoint_of(const CommandOptions& options);

// The command on a page, without options that do not change a result, such as the folder and the
// number of threads.
PageHead page_head(const CommandOptions& options,
                   const std::vector<std::filesystem::path>& recordings = {},
                   const std::vector<std::filesystem::path>& holdouts = {});

}  // namespace photorque
