// What may be wrong with a module: its numbers, what they do to it, and what is expected of them.
#pragma once

#include <functional>
#include <span>

#include "diagnosis/light/module/nominal.h"
#include "inference/estimator/parameter.h"

namespace photorque {

struct ModuleHypothesis {
  std::string kind;         // empty: nothing, or a law without physics
  std::string label;        // for people: "cell_cracked (3 cells)"
  std::string explanation;  // a sentence of physics without a full stop
  bool is_empirical = false;
  int count = 0;            // of cells; 0: not a number of cells
  double alternatives = 1;  // of which this is one: other numbers of cells
  std::vector<inference::Parameter> parameters;
  std::vector<std::vector<double>> starts;  // of the parameters; none: as they are
  std::function<void(std::span<const double> x, ModuleState& state, ModuleCell& cell)> act;
  // The keys of the report from the parameters, in SI.
  struct Number {
    std::string key;
    std::function<double(std::span<const double> x)> value;
  };
  std::vector<Number> numbers;
};

// The first is that nothing is missing.
std::vector<ModuleHypothesis> module_hypotheses(const ModuleDesign& design,
                                                const ModuleNominal& nominal);

}  // namespace photorque
