// The program: reads the command line, runs one verb, turns exceptions into exit statuses.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <limits>
#include <set>

#include "core/errors.h"
#include "core/provenance.h"
#include "core/settings/settings.h"
#include "tools/commands/manual.h"
#include "tools/commands/verb.h"

namespace photorque {

std::filesystem::path CommandLine::out_folder() const {
  return out ? *out : std::filesystem::path("out") / experiment.stem() / verb;
}

namespace {

void add_options(CLI::App& command, CommandLine& line) {
  command.add_option("experiment", line.experiment, "Experiment file (TOML)")->required();
  command.add_option("--set", line.overrides, "Change a key of the experiment: KEY=VALUE")
      ->allow_extra_args(false);
  command.add_option("--out", line.out, "Folder for the results (default: out/EXPERIMENT/VERB)");
  command.add_option("--threads", line.threads, "Threads to use (default: all)")
      ->check(CLI::Range(0, 1024));
  command.add_option("--seed", line.seed, "Seed of all randomness, over the experiment's own")
      ->check(CLI::Range(int64_t{0}, std::numeric_limits<int64_t>::max()));
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

// What is wrong without a file of its own is wrong in the experiment.
int run_verb(const Verb& verb, const CommandLine& line) {
  try {
    verb.run(line);
    return 0;
  } catch (const InputError& error) {
    const std::string what = error.what();
    if (error.names_file() || line.experiment.empty() || what.starts_with("--")) throw;
    std::fprintf(stderr, "%s: %s\n", line.experiment.c_str(), what.c_str());
    return 2;
  }
}

int run(int argc, char** argv) {
  CLI::App app("Light, torque and attitude of free-floating platforms.");
  app.name("photorque");
  const Provenance build = build_provenance();
  app.set_version_flag("--version", "photorque " + build.version + " (git " + build.git_hash + ")");
  app.require_subcommand(0, 1);
  CommandLine line;
  const std::vector<Verb> verbs = all_verbs();
  for (const Verb& verb : verbs) {
    CLI::App* command = app.add_subcommand(verb.name, verb.summary);
    add_options(*command, line);
    if (verb.traces_light) {
      command
          ->add_option("--target-error", line.target_error,
                       "Add rays until every bin above a tenth of the peak has this relative "
                       "standard error (0.01: 1 %)")
          ->check(CLI::Range(1e-6, 1.0));
      command
          ->add_option("--max-time", line.max_time_s,
                       "Stop adding rays before this many seconds have passed")
          ->check(CLI::PositiveNumber);
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
    if (verb.takes_cases) {
      command->add_option("--cases", line.cases, "Score this folder of cases instead of new ones");
      command->add_flag("--only-make", line.only_make, "Make the cases, diagnose nothing");
    }
    if (verb.takes_scene) {
      command->add_option("--scene", line.scene, "A model (glTF or GLB) to be lit");
    }
    if (verb.takes_shard) {
      command->add_option("--shard", line.shard,
                          "K/N: only every Nth design, from the Kth; the run that finds all "
                          "designs done writes the table");
    }
  }
  Manual manual;
  add_manual(app, manual);
  if (argc > 1 && argv[1][0] != '-') {
    std::set<std::string> known;
    for (const Verb& verb : verbs) known.insert(verb.name);
    if (!known.contains(argv[1])) {
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
    std::fprintf(stderr, "photorque: %s (see photorque --help)\n", error.what());
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
      if (line.out && line.out->empty()) throw InputError({"--out"}, "", "nothing", "a folder");
      return run_verb(verb, line);
    }
  }
  std::fprintf(stderr, "photorque: A subcommand is required (see photorque --help)\n");
  return 2;
}

}  // namespace
}  // namespace photorque

int main(int argc, char** argv) {
  try {
    const int status = photorque::run(argc, argv);
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
