// Predictions of segments of recordings by explanations that are fitted to other segments.
//
// For a real machine the residual is not white noise. No distribution then gives the fall of χ²
// that distinguishes a missing effect from a curve that follows the residual. Left-out segments
// decide: they show whether an effect predicts, and how much the gain varies between segments.
#pragma once

#include <vector>

#include "diagnosis/attitude/domain.h"
#include "inference/whiteness.h"

namespace photorque {

class CrossValidation {
 public:
  // Cuts the runs into about `wanted` segments with about equal numbers of blocks. If there are as
  // many runs, each is one segment, and only its initial conditions are fitted to it.
  CrossValidation(const AttitudeDomain& domain, std::vector<Observation> train,
                  std::vector<Observation> held, size_t wanted, int threads);

  size_t count() const { return segments_.size(); }

  // χ² of every segment, as predicted by the trial (fitted to the train runs) after a refit to
  // other segments; each refit leaves out a fifth of them. Infinite where it cannot be evaluated.
  std::vector<double> chi2(const Trial& trial) const;

 private:
  struct Segment {
    size_t run, first, last;  // blocks [first, last)
  };
  std::vector<double> predicted(const Trial& trial, const std::vector<RunStart>& begins,
                                size_t fold) const;

  const AttitudeDomain& domain_;
  int threads_;
  std::vector<Observation> runs_;
  size_t train_;  // number of train runs, which come first
  std::vector<Segment> segments_;
};

}  // namespace photorque
