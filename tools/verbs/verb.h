// A command of the program: its options as data, and the function that runs with them. One file
// each, which needs no library of command lines: tools/program parses the options and prints help
// and manual.
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
  std::string verb;                          // the program sets it
  std::string name;                          // of the results; empty: that of the experiment
  std::optional<std::filesystem::path> out;  // --out
  bool quiet = false;                        // no text but errors
  bool json = false;                         // the summary as JSON on standard output
  bool verbose = false;                      // all lines on the terminal
  std::string format;                        // further formats of the results: "exr,svg"
  std::string style = "page";                // of pictures
  bool page = false;                         // --page, of commands that have it
  std::optional<double> checkpoint_min;      // --checkpoint, likewise

  // --out, or out/NAME/VERB below the current folder.
  std::filesystem::path out_folder() const;
};

// The program around a command.
struct Program {
  const std::vector<Verb>& verbs;
  Interruption* interruption;  // null: a signal leaves incomplete files
};

// One option: where its value goes, and what --help says of it. Options are "--page" or "-o,--out";
// a name without hyphens is an argument known by its place.
struct Option {
  std::string names;
  std::variant<bool*, int*, std::string*, std::filesystem::path*,
               std::optional<std::filesystem::path>*, std::optional<double>*,
               std::optional<uint64_t>*, std::vector<std::string>*,
               std::vector<std::filesystem::path>*>
      value;
  std::string help;
  bool is_required = false;
  bool is_one_each = false;  // of lists: every item has the option before it
  template <class Number>
  using Between = std::pair<Number, Number>;
  std::variant<std::monostate, Between<int>, Between<int64_t>, Between<double>> range = {};
  // The mistake in a text; empty: nothing.
  std::function<std::string(const std::string&)> mistake = {};
};

// A verb with options that can be parsed, then run.
struct Command {
  enum class Folder { none, own, shared };  // that it writes into: alone, or with others like it

  std::shared_ptr<CommandOptions> options;
  std::vector<Option> list = {};
  Folder folder = Folder::none;
  // The mistake in a combination of options, as a sentence; empty: nothing.
  std::function<std::string()> mistake = {};
  std::function<void(const Program&)> run = {};

  // --threads, --seed, --max-memory, --quiet, --json, --verbose.
  void add_common(CommandOptions& common);
  // --out, --format and --style.
  void add_results(CommandOptions& common);
  // The experiment with --set, those of results, and the common options.
  void add_experiment(CommandOptions& common, Folder writes = Folder::own, bool required = true);
  // Also the options of a trace: --target-error, --max-time, --allow-outside.
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
  // Of an experiment: the tables that it reads, and those that it requires, in words.
  std::vector<std::string> tables = {};
  std::string needs = {};
  // One design of a sweep over it: no text, no files. Empty: it gives no figures.
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

// Options of an experiment, and of one that is traced and may become a page.
void experiment_options(Command& command, CommandOptions& options);
void traced_options(Command& command, CommandOptions& options);
void traced_page_options(Command& command, CommandOptions& options);

// A command with the options of an experiment that writes what `run` gives.
std::function<Command()> command_that_writes(RunResult (*run)(const RunOptions&, const Console&));

// Every verb named in tools/CMakeLists.txt, in that order.
std::vector<Verb> all_verbs();

// Text on standard output, of commands that write results at most 30
// lines without --verbose; silent with --quiet, and with
// --json, where only the summary appears. What is beyond is left out before the last lines, but no
// warning. A bar where standard error is a terminal; else a line of words at most every ten
// seconds.
Console terminal(const CommandOptions& options);

// The formats and the style of --format and --style. InputError for a format that does not exist.
RunFormats formats_of(const CommandOptions& options);

// Writes the results and summary.json into the command's folder (write_run) and says where; with
// --json prints the summary.
void write_results(const CommandOptions& options, const Console& console, const RunResult& result);

// The file of --checkpoint; null without the option.
std::unique_ptr<CheckpointFile> checkpoint_of(const CommandOptions& options);

// The description of the command on a page: without what changes no result, such as the folder and
// the number of threads.
PageHead page_head(const CommandOptions& options,
                   const std::vector<std::filesystem::path>& recordings = {},
                   const std::vector<std::filesystem::path>& holdouts = {});

}  // namespace photorque
