// The program: reads the command line, runs one verb, turns exceptions into exit statuses.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <new>
#include <set>
#include <system_error>

#include "core/errors.h"
#include "core/provenance.h"
#include "core/settings/settings.h"
#include "core/text/numbers.h"
#include "images/loading/functions.h"
#include "images/publishing/staged_files.h"
#include "tools/commands/verb.h"
#include "tools/guards/interruption.h"
#include "tools/guards/memory.h"
#include "tools/guards/output_folder.h"
#include "tools/manual/pages.h"

namespace photorque {

std::filesystem::path CommandLine::out_folder() const {
  if (out) return *out;
  return std::filesystem::path("out") / (guess.empty() ? experiment.stem() : name_of_guess()) /
         verb;
}

std::filesystem::path CommandLine::name_of_guess() const {
  std::filesystem::path name = guess.front().filename();
  while (name.has_extension()) name = name.stem();
  return name;
}

namespace {

std::string seconds_above_zero(const std::string& text) {
  const std::optional<double> seconds = number_in(text);
  return seconds && *seconds > 0.0 ? "" : "found " + text + ", expected a number of seconds > 0";
}

std::string minutes_above_zero(const std::string& text) {
  const std::optional<double> minutes = number_in(text);
  const bool good = minutes && *minutes > 0.0 && *minutes <= 1e6;
  return good ? "" : "found " + text + ", expected a number of minutes > 0";
}

void add_options(CLI::App& command, const Verb& verb, CommandLine& line) {
  if (verb.takes_experiment) {
    command.add_option("experiment", line.experiment, "Experiment file (TOML)")
        ->required(!verb.takes_guess);
    command.add_option("--set", line.overrides, "Change a key of the experiment: KEY=VALUE")
        ->allow_extra_args(false);
  }
  if (verb.writes) {
    command.add_option("-o,--out", line.out,
                       "Folder for the results (default: out/EXPERIMENT/VERB)");
  }
  command.add_option("--threads", line.threads, "Threads to use (default: all)")
      ->check(CLI::Range(0, 1024));
  command.add_option("--seed", line.seed, "Seed of all randomness, over the experiment's own")
      ->check(CLI::Range(int64_t{0}, std::numeric_limits<int64_t>::max()));
  command
      .add_option("--max-memory", line.max_memory_GB,
                  "Most memory to take, in GB (default: nine tenths of what the machine has free)")
      ->check(CLI::Range(0.5, 1e6))
      ->check([](const std::string& text) {
        return number_in(text) ? "" : text + " is no finite number";
      });
  command.add_flag("--quiet", line.quiet, "Print nothing but errors");
  command.add_flag("--json", line.json, "Print the summary as JSON instead of text");
}

// For packages: what other programs read of the same options.
struct Manual {
  bool page = false;
  std::string shell;
};

void add_manual(CLI::App& app, Manual& manual) {
  app.add_flag("--man", manual.page, "Print the manual page (troff)");
  app.add_option("--completion", manual.shell,
                 "Print the completion script of a shell: bash, zsh or fish")
      ->check(CLI::IsMember(completion_shells));
}

// In the verb's output folder, which signals leave clean.
void run_in_folder(const Verb& verb, const CommandLine& line) {
  const auto others = verb.takes_shard ? OutputFolder::Others::share : OutputFolder::Others::refuse;
  std::optional<Interruption::Watch> watch;
  if (line.interruption != nullptr) watch.emplace(*line.interruption, line.out_folder());
  const OutputFolder folder(line.out_folder(), others);
  const std::string input = line.experiment.filename().string();
  std::error_code none;
  if (std::filesystem::equivalent(line.experiment, line.out_folder() / input, none) &&
      is_result_of(line.out_folder(), verb.name, input)) {
    throw InputError({}, "--out",
                     line.out_folder().string() + ", whose " + input + " the run would replace",
                     "another folder than that of its own input");
  }
  verb.run(line);
}

// What is wrong without a file of its own is wrong in the experiment.
int run_verb(const Verb& verb, const CommandLine& line) {
  try {
    if (verb.writes) {
      require_pictures();
      run_in_folder(verb, line);
    } else {
      verb.run(line);
    }
    return 0;
  } catch (const InputError& error) {
    const std::string what = error.what();
    if (error.names_file() || line.experiment.empty() || what.starts_with("--")) throw;
    std::fprintf(stderr, "%s: %s\n", line.experiment.c_str(), what.c_str());
    return 2;
  }
}

// A list behind --recording would swallow an experiment that follows it: each has its own option.
std::string hint_at(const CLI::ParseError& error, int argc, char** argv) {
  if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::ExtrasError)) return "";
  // An option that nobody knows is no item of a list.
  if (std::string_view(error.what()).find(" -") != std::string_view::npos) return "";
  for (const char* option : {"--recording", "--holdout", "--set"}) {
    if (std::find(argv + 1, argv + argc, std::string_view(option)) == argv + argc) continue;
    return std::string("; repeat ") + option + " before each of several";
  }
  return "";
}

int run(int argc, char** argv, Interruption& interruption) {
  CLI::App app("Light, torque and attitude of free-floating platforms.");
  app.name("photorque");
  const Provenance build = build_provenance();
  app.set_version_flag("--version", "photorque " + build.version + " (git " + build.git_hash + ")");
  app.require_subcommand(0, 1);
  CommandLine line;
  line.interruption = &interruption;
  const std::vector<Verb> verbs = all_verbs();
  for (const Verb& verb : verbs) {
    CLI::App* command = app.add_subcommand(verb.name, verb.summary);
    add_options(*command, verb, line);
    if (verb.traces_light) {
      command
          ->add_option("--target-error", line.target_error,
                       "Add rays until every bin above a tenth of the peak has this relative "
                       "standard error (0.01: 1 %)")
          ->check(CLI::Range(1e-6, 1.0));
      command
          ->add_option("--max-time", line.max_time_s,
                       "Stop adding rays before this many seconds have passed")
          ->check(seconds_above_zero);
      command->add_flag("--allow-outside", line.allow_outside,
                        "Follow links and paths of the model that lead out of its folder");
    }
    if (verb.takes_recordings) {
      command->add_option("--recording", line.recordings, "A recording (CSV); may be repeated")
          ->allow_extra_args(false);
    }
    if (verb.takes_holdouts) {
      command
          ->add_option("--holdout", line.holdouts,
                       "A recording held out: never fitted, it judges the finding; as above")
          ->allow_extra_args(false);
    }
    if (verb.takes_guess) {
      command->add_option("--guess", line.guess,
                          "Instead of an experiment: write one that fits the columns of these "
                          "recordings (CSV), its assumptions marked");
    }
    if (verb.takes_truth) {
      command->add_option("--truth", line.truth,
                          "What is true of the recording's motion (CSV with q_w ..., such as "
                          "time_history.csv of propagate), to compare with");
    }
    if (verb.takes_keys) {
      command->add_option("--out", line.out, "Write the schema into this file");
      command->add_option("--key", line.key, "Explain one key instead: source.power_W");
      command
          ->add_option("--document", line.documents,
                       "Instead renew the tables of keys in this Markdown file, between its marks")
          ->allow_extra_args(false);
    }
    if (verb.takes_scene) {
      command->add_option("--scene", line.scene, "A model (glTF, GLB, STL or OBJ) to be lit");
    }
    if (verb.takes_checkpoint) {
      command
          ->add_option(
              "--checkpoint", line.checkpoint_min,
              "Keep the state of the run in the folder of results (VERB.checkpoint) every so "
              "many minutes; after a kill the same command goes on from there")
          ->check(minutes_above_zero);
    }
    if (verb.draws_page) {
      command->add_flag("--page", line.page,
                        "Write page.html too: scene, maps and curves to look at in a browser");
    }
    if (verb.bakes) {
      command->add_flag("--bake", line.bake,
                        "Write baked.glb too: the scene with the irradiance as textures and vertex "
                        "colours, for viewers of glTF");
    }
    if (verb.takes_shard) {
      command->add_option("--shard", line.shard,
                          "K/N: only every Nth design, from the Kth; the run that finds all "
                          "designs done writes the table");
      command->add_flag("--collect", line.collect,
                        "Run nothing: the table of what all shards have done, also of those that "
                        "did not come to an end");
    }
  }
  Manual manual;
  add_manual(app, manual);
  if (argc > 1 && argv[1][0] != '-') {
    std::set<std::string> known;
    for (const Verb& verb : verbs) known.insert(verb.name);
    if (!known.contains(argv[1])) {
      if (std::string_view(argv[1]).ends_with(".toml")) {
        std::fprintf(stderr,
                     "photorque: found %s, expected a command before it: did you forget it? e.g. "
                     "photorque power %s (see photorque --help)\n",
                     argv[1], argv[1]);
        return 2;
      }
      const std::string likest = nearest(argv[1], known);
      std::fprintf(stderr, "photorque: unknown command \"%s\"%s (see photorque --help)\n", argv[1],
                   likest.empty() ? "" : (", perhaps \"" + likest + "\"").c_str());
      return 2;
    }
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::fprintf(stderr, "photorque: %s%s (see photorque --help)\n", error.what(),
                 hint_at(error, argc, argv).c_str());
    return 2;
  }
  if (manual.page || !manual.shell.empty()) {
    const std::string text =
        manual.page ? man_page(app, build.version) : completion_script(app, manual.shell);
    std::fputs(text.c_str(), stdout);
    return 0;
  }
  for (const Verb& verb : verbs) {
    if (app.got_subcommand(verb.name)) {
      line.verb = verb.name;
      if (verb.takes_guess && line.experiment.empty() == line.guess.empty()) {
        std::fprintf(stderr, "photorque: %s (see photorque %s --help)\n",
                     line.guess.empty() ? "experiment is required, or --guess RECORDING"
                                        : "an experiment beside --guess: one of the two",
                     verb.name.c_str());
        return 2;
      }
      if (line.out && line.out->empty()) throw InputError({"--out"}, "", "nothing", "a folder");
      hold_memory(line.max_memory_GB);
      return run_verb(verb, line);
    }
  }
  std::fprintf(stderr, "photorque: A subcommand is required (see photorque --help)\n");
  return 2;
}

// Where memory ends in a thread or a destructor no exception reaches main().
[[noreturn]] void end_without_memory() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    std::fputs("numerical failure: not enough memory\n", stderr);
    std::_Exit(3);
  } catch (const std::system_error&) {
    std::fputs("numerical failure: not enough memory for another thread\n", stderr);
    std::_Exit(3);
  } catch (...) {
    std::abort();
  }
  std::abort();
}

}  // namespace
}  // namespace photorque

int main(int argc, char** argv) {
  std::set_terminate(photorque::end_without_memory);
  // A file beyond the limit of its size is a write that fails, not an end.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    photorque::Interruption interruption;
    const int status = photorque::run(argc, argv, interruption);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      std::fprintf(stderr, "photorque: standard output could not be written\n");
      return 3;
    }
    return status;
  } catch (const photorque::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const photorque::NumericalError& error) {
    std::fprintf(stderr, "numerical failure: %s\n", error.what());
    return 3;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "numerical failure: not enough memory\n");
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "numerical failure: %s\n", error.what());
    return 3;
  }
}
