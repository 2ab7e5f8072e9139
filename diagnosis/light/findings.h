// Findings of a diagnosis of light and power as sentences and numbers.
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

// The named effects of the chosen trial, each with the effects that are indistinguishable from it
// in these recordings.
std::vector<FoundEffect> found_light_effects(const LightAnswer& answer,
                                             const std::vector<FittedRun>& runs);

// The best trial of every set of names, best first, relative to the nominal model.
std::vector<Alternative> light_alternatives(const LightAnswer& answer);

// Variables on which the nominal residuals depend, strongest first, by the fraction of the χ² above
// noise that functions of each variable alone remove.
std::vector<Where::Dependence> light_dependences(const LightTrial& about,
                                                 const LightCandidates& all,
                                                 const std::vector<FittedRun>& runs);

// The array with the cells that the found effects concern. Nothing without an array or without
// effects.
std::optional<DrawnArray> drawn_array(const LightLab& lab, const std::vector<FoundEffect>& effects);

// Parameters with a prior, after the fit.
std::vector<FittedParameter> refined_light_priors(const LightAnswer& answer);

// Kinds other than that of the chosen trial's candidate `which` that explain all `runs` equally
// well in its place.
std::vector<std::string> light_rivals(const LightAnswer& answer, size_t which,
                                      const std::vector<FittedRun>& runs);

// The trial's candidate `which` at every other place of its kind (a cell, an LED …), with its
// deficit in log evidence on all `runs`.
std::vector<inference::Checks::Place> other_light_places(const LightTrial& trial, size_t which,
                                                         const LightCandidates& all,
                                                         const std::vector<FittedRun>& runs,
                                                         int threads);

// Readings and both models: for runs, voltage and current over time and the motion; for scans and
// sweeps, every row.
RecordingSeries light_series(const LightAnswer& answer, const FittedRun& run, bool is_held_out);

// One sentence that states the verdict, for the top of the report.
std::string light_sentence(const Diagnosis& diagnosis);

// segments.cpp: cross-validation by segments of recordings that a fit left out. The rows of a
// segment are spread over the whole recording. A cell or a shadow changes only a part of a curve or
// scan, and this change must be visible in every segment.

// The gain of the candidate `which` of the trial in five-fold cross-validation, in standard errors:
// positive if the trial predicts left-out segments of the runs better with the candidate than
// without it. Each fit leaves out a fifth of the segments. nullopt if a run has too few rows.
std::optional<double> gain_over_segments(const LightTrial& trial, size_t which,
                                         const LightCandidates& all,
                                         const std::vector<FittedRun>& runs, int threads);

}  // namespace photorque
