// The plan of a sweep: the values that the designs give to keys of the experiment, objectives and
// constraints.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/settings/typed_keys.h"
#include "tools/sweeps/outcome.h"

namespace photorque {

// One key of the experiment and a list of its values, as TOML text ("3.5", "\"gaussian\"").
struct SweepAxis {
  std::string key;
  // One value per design of a random plan, or one per step of a grid.
  std::vector<std::string> values = {};
  std::string name = {};  // name in output; empty: derived from the key
  // Bounds for an optimisation; empty if the plan gives single values or a distribution.
  std::optional<double> low = {}, high = {};
};

// A key that takes several values within one design. Figures are the weighted mean over these
// values.
struct MeanOver {
  std::string key;
  std::vector<std::string> values;
  std::vector<double> weights;  // sum to one
};
// A key that takes several values within one design. Objectives and constraints use the worst case
// over these values.
struct WorstOver {
  std::string key;
  std::vector<std::string> values;
};

// A figure of summary.json, or its absolute value. Users write the absolute value as
// "|torque_y_body_N_m|"; its column in tables is abs_torque_y_body_N_m.
struct SweepFigure {
  std::string name;
  bool absolute = false;
  std::string column() const { return absolute ? "abs_" + name : name; }
};

struct Objective {
  SweepFigure figure;
  bool maximise = true;
};

// Bounds on a figure of a design, in the unit of the figure.
struct Constraint {
  SweepFigure figure;
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
};

// A manufacturing tolerance: the random error of the numbers of one key.
struct Tolerance {
  enum class Law { normal, uniform, seed };
  std::string key;
  Law law = Law::normal;
  // Standard deviation (normal) or half width (uniform), in the unit of the key.
  double width = 0.0;
  bool relative = false;  // whether `width` is relative to the value
};

// Random copies of a design within its tolerances. The n-th copy has the same random draws in every
// design, so that the comparison of designs does not depend on chance.
struct BuiltCopies {
  std::vector<Tolerance> tolerances;
  size_t copies = 0;
  double fraction = 0.95;  // fraction of the copies that reach the reported value
  bool of_every = false;  // true: copies of every design; false: of the best and the nominal design
  uint64_t seed = 1;
};

// Options of an optimisation: see Optimiser.
struct SearchPlan {
  size_t global = 0, local = 0;  // numbers of evaluations
  double precision = 1e-3;  // step at which the search ends, relative to the range of each axis
};

struct SweepPlan {
  std::string verb;                  // the command that every design runs
  std::vector<std::string> figures;  // names in the command's summary; empty: all
  // true: every combination of the axes' values; false: design n has the n-th value of every axis.
  bool grid = true;
  std::vector<SweepAxis> axes;
  std::vector<MeanOver> mean_over;
  std::vector<WorstOver> worst_over;
  std::vector<Objective> objectives;
  std::vector<Constraint> constraints;
  BuiltCopies built;
  SearchPlan search;

  // Number of designs; 0 if an axis is a range without steps, which only an optimisation can use.
  size_t designs() const;
  // Value of an axis in a design, and its index among the axis' values. In a grid the last axis
  // varies fastest.
  const std::string& value(size_t design, size_t axis) const;
  size_t place(size_t design, size_t axis) const;
  // Changes "KEY=VALUE" of a design, one per axis.
  Changes overrides(size_t design) const;

  // Number of combinations of the values of mean_over, and of worst_over.
  size_t mean_points() const;
  size_t worst_points() const;
  // Changes of each run of one design. The values of mean_over vary fastest.
  std::vector<Changes> runs_of(const Changes& design) const;
  // Weight of each point of mean_over in the mean.
  std::vector<double> mean_weights() const;

  // Column by which designs are ranked: that of the figure, or "p95_array_power_W" for the value
  // that the stated fraction of the built copies reaches.
  std::string judged_column(const Objective& objective) const;
  std::string built_column(const SweepFigure& figure) const;
};

// Reads the table [sweep], whose keys are listed in docs/experiment.md. Numbers are in the unit of
// the key of their axis.
SweepPlan read_sweep_plan(const Settings& sweep);

// Declaration of the table [sweep].
Key sweep_table();

// Keys that a plan lacks for an optimisation; empty if it is complete.
std::string missing_search_keys(const SweepPlan& plan);

// A number with 15 digits, which removes the rounding residue of its binary form.
std::string toml_number(double value);

// A value as TOML text, with its numbers by toml_number().
std::string toml_text(const SettingsNode& node);

// Sobol points of one dimension in (0, 1), and quantiles of the standard normal distribution.
std::vector<double> sobol_column(uint64_t seed, size_t dimension, size_t count);
double normal_quantile(double fraction);

}  // namespace photorque
