// Wild readings: those that no neighbour in place or time comes near.
#pragma once

#include "diagnosis/light/model/run.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

// The rows that are no outliers by the residuals of some model, in order. A model that is wrong
// leaves residuals that change from place to place, so what stands out must stand out from all of
// its neighbours and from the plane through them.
std::vector<size_t> rows_without_outliers(const LightRun& run, const Eigen::VectorXd& residuals,
                                          const Thresholds::Noise& limits);

// The same by a model that explains all but them: a reading that is off by five of its errors, and
// as far from the middle of its neighbours, is drawn once in a million. (One that is multiplied
// where there is little light is not off by more, and its place says much about where a beam ends.)
std::vector<size_t> rows_without_strays(const LightRun& run, const Eigen::VectorXd& residuals);

}  // namespace photorque
