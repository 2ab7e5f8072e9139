// The designs of a sweep: the values of the experiment's keys, objectives and constraints.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "tools/sweeps/outcome.h"

namespace photorque {

// One key of the experiment and its values in turn, as TOML ("3.5", "\"gaussian\"").
struct SweepAxis {
  std::string key;
  std::vector<std::string> values = {};  // of each design of a random plan, of each step of a grid
  std::string name = {};                 // as printed; empty: from the key
  // Where an optimisation may look; nothing where the plan gives single values or a distribution.
  std::optional<double> low = {}, high = {};
};

// A key that takes several values within one design: figures are their weighted mean.
struct MeanOver {
  std::string key;
  std::vector<std::string> values;
  std::vector<double> weights;  // sum to one
};
// A worst case over several values.
struct WorstOver {
  std::string key;
  std::vector<std::string> values;
};

// A figure of the summary, or its absolute value: written "|torque_y_body_N_m|", in tables
// abs_torque_y_body_N_m.
struct SweepFigure {
  std::string name;
  bool absolute = false;
  std::string column() const { return absolute ? "abs_" + name : name; }
};

struct Objective {
  SweepFigure figure;
  bool maximise = true;
};

// A constraint on a design, in the figure's unit.
struct Constraint {
  SweepFigure figure;
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
};

// A manufacturing tolerance: a key, and how far it is off.
struct Tolerance {
  enum class Law { normal, uniform, seed };
  std::string key;
  Law law = Law::normal;
  double width = 0.0;     // standard deviation, or half of the whole; in the key's unit
  bool relative = false;  // of the value itself
};

// Copies of a design as they would be built. The n-th has the same draws in every design, so that
// the comparison of designs does not depend on chance.
struct BuiltCopies {
  std::vector<Tolerance> tolerances;
  size_t copies = 0;
  double fraction = 0.95;  // that are to be at least as good as the stated figure
  bool of_every = false;   // design; else of the best and of the experiment as it stands
  uint64_t seed = 1;
};

// How a search for the best goes: see Optimiser.
struct SearchPlan {
  size_t global = 0, local = 0;  // evaluations
  double precision = 1e-3;       // of each axis' range
};

struct SweepPlan {
  std::string verb;                  // the command that every design runs
  std::vector<std::string> figures;  // of its summary; empty: all
  bool grid = true;                  // every combination; otherwise row by row
  std::vector<SweepAxis> axes;
  std::vector<MeanOver> mean_over;
  std::vector<WorstOver> worst_over;
  std::vector<Objective> objectives;
  std::vector<Constraint> constraints;
  BuiltCopies built;
  SearchPlan search;

  // None where an axis is a range without steps: for a search alone.
  size_t designs() const;
  // The value of an axis in a design. In a grid the last axis runs fastest.
  const std::string& value(size_t design, size_t axis) const;
  // "KEY=VALUE" of every axis.
  Changes overrides(size_t design) const;

  size_t mean_points() const;
  size_t worst_points() const;
  // The runs of one design: the changes of each, those of mean_over running fastest.
  std::vector<Changes> runs_of(const Changes& design) const;
  // The weight of each point of mean_over in the mean.
  std::vector<double> mean_weights() const;

  // The column by which designs are judged: that of the figure, or of what the stated fraction of
  // built copies reaches, "p95_array_power_W".
  std::string judged_column(const Objective& objective) const;
  std::string built_column(const SweepFigure& figure) const;
};

// Reads the table [sweep]; every key in docs/experiment.md. Numbers are in the unit of the axis'
// key.
SweepPlan read_sweep_plan(const Settings& sweep);

// The keys that a plan lacks for a search of the best design; empty: none.
std::string lacks_for_search(const SweepPlan& plan);

}  // namespace photorque
