// The designs of a sweep: which keys of an experiment take which values.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

// One key of the experiment and what it takes in turn, as TOML values ("3.5", "\"gaussian\"").
struct SweepAxis {
  std::string key;
  std::vector<std::string> values;  // of each design of a random plan, of each step of a grid
};

struct SweepPlan {
  std::string verb;                  // the command that every design runs
  std::vector<std::string> figures;  // of its summary; empty: all
  bool grid = true;                  // every combination; otherwise row by row
  std::vector<SweepAxis> axes;

  size_t designs() const;
  // The value of an axis in a design. In a grid the last axis runs fastest.
  const std::string& value(size_t design, size_t axis) const;
  // "KEY=VALUE" of every axis.
  std::vector<std::string> overrides(size_t design) const;
};

// A value as TOML text; tables are not values of a sweep.
std::string toml_text(const SettingsNode& node);

// Reads the table [sweep]:
//   verb = "power", figures = ["array_power_W"]
//   designs = 200, seed = 1            a random plan: Owen-scrambled Sobol points
//   [[sweep.axis]] key = "…" and one of
//     values = […]                      grid only
//     from = 1, to = 4                  grid: `count` equal steps, or factors with `spacing =
//                                       "logarithmic"`; random: uniform between the two
//     mean = 1, sigma = 0.1             random only: normal
// Numbers are in the unit of the axis' key.
SweepPlan read_sweep_plan(const Settings& sweep);

}  // namespace photorque
