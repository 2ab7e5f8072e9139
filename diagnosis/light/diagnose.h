// `diagnose` for light and power: compares scans, sweeps and runs with the nominal model of lamps
// and array, and finds missing effects.
//
// Observe (outliers dropped) → fit the nominal model → search → weigh with the held-out data →
// decide → report. The engine is inference/; the forward model (model/) and the kinds of effects
// (effects/) are special to light.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/diagnosis.h"
#include "diagnosis/light/candidate.h"
#include "diagnosis/light/model/lab.h"
#include "diagnosis/light/model/recording.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

struct LightDiagnoseOptions {
  int threads = 0;  // 0: all
  // Of each recording: of longer ones every so many rows are used.
  size_t max_rows = 5000, max_scan_rows = 12000;
  double holdout_fraction = 0.25;  // of each recording, where there is no holdout
  Thresholds limits;
  std::function<void(const std::string&)> progress;  // called at each step; may be empty
};

// Wild readings: those that no neighbour in place or time comes near.
//
// The rows that are no outliers by the residuals of some model, in order. A model that is wrong
// leaves residuals that change from place to place, so what stands out must stand out from all of
// its neighbours and from the plane through them.
std::vector<size_t> rows_without_outliers(const LightRun& run, const Eigen::VectorXd& residuals,
                                          const Thresholds::Noise& limits);

// Rows without outliers by a model that explains all other readings: a reading that is off by five
// of its errors, and as far from the median of its neighbours, occurs once in a million. (A reading
// that is multiplied where there is little light is not off by more, and its place says much about
// where a beam ends.)
std::vector<size_t> rows_without_strays(const LightRun& run, const Eigen::VectorXd& residuals);

// InputError for recordings that the experiment cannot explain at all: curves without an array. The
// result does not depend on the number of threads.
Diagnosis diagnose_light(const LightLab& lab, const LightBelief& nominal,
                         std::vector<LightRecording> recordings,
                         std::vector<LightRecording> holdouts,
                         const LightDiagnoseOptions& options = {});

}  // namespace photorque
