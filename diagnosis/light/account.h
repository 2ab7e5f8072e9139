// Findings about light and power as sentences and numbers for the reader of a diagnosis.
#pragma once

#include "diagnosis/diagnosis.h"
#include "diagnosis/light/trial.h"
#include "inference/decide.h"

namespace photorque {

struct LightAnswer {
  LightCandidates all;
  std::vector<LightTrial> trials;
  inference::Decision decision;

  const LightTrial& chosen() const { return trials[decision.chosen]; }
};

// The named effects of the chosen trial, each with the effects from which these recordings do not
// distinguish it.
std::vector<FoundEffect> found_light_effects(const LightAnswer& answer,
                                             const std::vector<FittedRun>& runs);

std::vector<Alternative> light_alternatives(const LightAnswer& answer);

// Variables on which the nominal residuals depend, the strongest first: by how much functions of
// each variable alone lower the part of χ² above noise.
std::vector<Where::Dependence> light_dependences(const LightTrial& about,
                                                 const LightCandidates& all,
                                                 const std::vector<FittedRun>& runs);

// The array with the cells that the found effects concern; nothing without an array or such cells.
std::optional<DrawnArray> drawn_array(const LightLab& lab, const std::vector<FoundEffect>& effects);

// Parameters with a prior, after the fit.
std::vector<FittedParameter> refined_light_beliefs(const LightAnswer& answer);

// Kinds other than that of the chosen trial's candidate `which` that explain all `runs` as well in
// its place.
std::vector<std::string> light_rivals(const LightAnswer& answer, size_t which,
                                      const std::vector<FittedRun>& runs);

// The trial's candidate at `which` at each other place that its kind has (a cell, an LED …), and by
// how much log evidence all `runs` make it worse there.
std::vector<inference::Checks::Place> other_light_places(const LightTrial& trial, size_t which,
                                                         const LightCandidates& all,
                                                         const std::vector<FittedRun>& runs,
                                                         int threads);

// Readings beside both models: of runs voltage and current over time and the motion, of scans and
// sweeps every row.
RecordingSeries light_series(const LightAnswer& answer, const FittedRun& run, bool is_held_out);

std::string light_sentence(const Diagnosis& diagnosis);

}  // namespace photorque
