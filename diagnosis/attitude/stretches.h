// How well explanations predict stretches of recordings that they were not fitted to.
//
// What a model leaves of a real machine is no noise, and no distribution says by how much a missing
// effect must lower χ² to be more than a bend that follows it. Stretches that were never fitted do:
// they show whether an effect predicts, and how much that differs from stretch to stretch.
#pragma once

#include <vector>

#include "diagnosis/attitude/domain.h"
#include "inference/whiteness.h"

namespace photorque {

class Stretches {
 public:
  // Runs in stretches of about equally many blocks, about `wanted` in all; of as many runs each is
  // one, and only how it began is taken from it.
  Stretches(const AttitudeDomain& domain, std::vector<Observation> train,
            std::vector<Observation> held, size_t wanted, int threads);

  size_t count() const { return stretches_.size(); }

  // χ² of every stretch as the trial, which was fitted to the train runs, predicts it after a fit
  // to all others: a fifth of the stretches is left out in turn. Infinite where that cannot be
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
