// Predictions of segments of recordings by explanations that were fitted to the other segments.
//
// The residual of a real machine's model is not noise, and no distribution gives the fall of χ² by
// which a missing effect differs from a curve that follows the residual. Segments that were not
// fitted decide: they show whether an effect predicts, and how much this differs between segments.
#pragma once

#include <vector>

#include "diagnosis/attitude/domain.h"
#include "inference/whiteness.h"

namespace photorque {

class Stretches {
 public:
  // Cuts the runs into about `wanted` segments of about equally many blocks. If there are as many
  // runs, each is one segment, and only its initial conditions are fitted to it.
  Stretches(const AttitudeDomain& domain, std::vector<Observation> train,
            std::vector<Observation> held, size_t wanted, int threads);

  size_t count() const { return stretches_.size(); }

  // χ² of every segment, as predicted by the trial (which was fitted to the train runs) after a fit
  // to other segments: each fit leaves out a fifth of the segments. Infinite where that cannot be
  // evaluated.
  std::vector<double> chi2(const Trial& trial) const;

 private:
  struct Stretch {
    size_t run, first, last;  // blocks [first, last)
  };
  std::vector<double> predicted(const Trial& trial, const std::vector<RunStart>& begins,
                                size_t fold) const;

  const AttitudeDomain& domain_;
  int threads_;
  std::vector<Observation> runs_;
  size_t train_;  // so many of them
  std::vector<Stretch> stretches_;
};

using inference::gain_sigma;

}  // namespace photorque
