// Wild readings: those that no neighbour in place or time comes near.
#pragma once

#include "diagnosis/light/model/run.h"
#include "inference/limits/thresholds.h"

namespace photorque {

// The rows that are no outliers by the residuals of some model, in order. A model that is wrong
// leaves residuals that change from place to place, so what stands out must stand out from all of
// its neighbours and from the plane through them.
std::vector<size_t> rows_without_outliers(const LightRun& run, const Eigen::VectorXd& residuals,
                                          const Thresholds::Noise& limits);

}  // namespace photorque
