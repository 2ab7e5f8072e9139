// `diagnose` for light and power: compares scans, sweeps and runs with the nominal model of lamps
// and array, and finds missing effects.
//
// The steps are: observe (outliers dropped) → fit the nominal model → search → weigh with the
// held-out data → decide → report. The engine is inference/; the forward model (model/) and the
// kinds of effects (effects/) are specific to light.
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
  int threads = 0;                                   // 0: all
  std::function<void(const std::string&)> progress;  // called at each step; may be empty
};

// Outliers: readings that deviate from all neighbours in place or time.
//
// Returns the rows without outliers under the residuals of some model, in order. Residuals of a
// wrong model vary with place, so an outlier must deviate from all of its neighbours and from the
// plane through them.
std::vector<size_t> rows_without_outliers(const LightRun& run, const Eigen::VectorXd& residuals,
                                          const Thresholds::Noise& limits);

// Returns the rows without outliers under a model that explains all other readings. A reading that
// is off by five standard errors, and as far from the median of its neighbours, occurs by chance
// once in a million. (A wrong factor on a reading in little light causes no larger deviation, and
// such readings strongly affect the fitted edge of a beam.)
std::vector<size_t> rows_within_noise(const LightRun& run, const Eigen::VectorXd& residuals);

// Without holdouts a quarter of each recording is held out. Throws InputError for recordings that
// the experiment cannot model: curves without an array. The result is independent of the number of
// threads.
Diagnosis diagnose_light(const LightLab& lab, const NominalLight& nominal,
                         std::vector<LightRecording> recordings,
                         std::vector<LightRecording> holdouts,
                         const LightDiagnoseOptions& options = {});

}  // namespace photorque
