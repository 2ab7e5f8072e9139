// What every command of the program shares.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/runs/options.h"

namespace photorque {

class Interruption;  // tools/guards/interruption.h
struct RunResult;    // tools/runs/result.h

// The command line: photorque VERB EXPERIMENT [--set KEY=VALUE …] [--out DIR] …
struct CommandLine : RunOptions {
  std::string verb;
  std::optional<std::filesystem::path> out;       // --out
  bool quiet = false;                             // no text but errors
  bool json = false;                              // the summary as JSON on standard output
  std::vector<std::filesystem::path> recordings;  // --recording, of commands that take some
  std::vector<std::filesystem::path> holdouts;    // --holdout, recordings held out from a fit
  std::vector<std::filesystem::path> guess;       // --guess, recordings without an experiment
  std::optional<std::filesystem::path> truth;     // --truth, what is known of a recording's motion
  std::string shard;                              // --shard K/N, of a sweep
  std::optional<std::filesystem::path> scene;     // --scene, of a new experiment
  bool collect = false;                           // --collect, of a sweep
  bool page = false;                              // --page: also one HTML page to look at
  bool bake = false;                              // --bake: also the lit scene as glTF
  std::string key;                                // --key, to be explained
  std::vector<std::filesystem::path> documents;   // --document, whose tables of keys are renewed
  std::optional<double> checkpoint_min;           // --checkpoint, minutes between two states
  Interruption* interruption = nullptr;           // the program's, when it is one
  // Of a run in a sweep: takes what came out, and no file is written.
  std::function<void(const RunResult&)> take_result = {};

  // --out, or out/EXPERIMENT/VERB below the current folder; without an experiment the name of the
  // recording that one is guessed from.
  std::filesystem::path out_folder() const;
  // The first recording of --guess without folder and endings: "run1" of data/run1.csv.gz.
  std::filesystem::path name_of_guess() const;
};

// One command. `run` does everything and throws what goes wrong.
struct Verb {
  std::string name;
  std::string summary;  // one sentence for --help
  std::function<void(const CommandLine&)> run;
  bool traces_light = false;  // --target-error, --max-time
  bool takes_recordings = false;
  bool takes_holdouts = false;
  bool takes_guess = false;  // instead of an experiment
  bool takes_truth = false;
  bool takes_shard = false;
  bool takes_scene = false;
  bool takes_checkpoint = false;
  bool draws_page = false;
  bool bakes = false;
  bool takes_keys = false;  // --out FILE, --key, --document
  bool takes_experiment = true;
  bool writes = true;  // into its output folder
};

// Every verb named in tools/CMakeLists.txt, in that order.
std::vector<Verb> all_verbs();

}  // namespace photorque
