// An injected case as files: the nominal model, what was recorded, and the truth.
#pragma once

#include <filesystem>
#include <string>

#include "tools/proof/case.h"

namespace photorque {

// The experiment file. `told_truth` adds the injected effects with their true numbers: the same
// program given that is the oracle that a diagnosis is measured against.
std::string injected_experiment(const InjectedCase& injected, bool told_truth);

// The experiment with every number true, and the start of run 0 or 1: `propagate` repeats that run.
// Empty where a law outside of the catalogue acts.
std::string injected_truth_toml(const InjectedCase& injected, size_t run);

// The recording of run 0 or 1 as the contract's CSV, read by instruments with noise and, where the
// case is dirty, faults.
std::string injected_recording(const InjectedCase& injected, size_t run);

std::string injected_truth_json(const InjectedCase& injected);

// Writes experiment.toml, run1.csv.gz, run2.csv.gz, oracle.toml, truth1.toml and truth2.toml and,
// last, truth.json: a folder that has one is complete.
void write_injected_case(const InjectedCase& injected, const std::filesystem::path& folder);

}  // namespace photorque
