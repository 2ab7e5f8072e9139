// Whether a filter's errors agree with its predicted errors.
//
// Source: Y. Bar-Shalom, X. Li, T. Kirubarajan, Estimation with Applications to Tracking and
// Navigation (2001), sec. 5.4: normalised errors squared (NEES) and innovations squared (NIS).
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "attitude/filtering/kalman.h"

namespace photorque {

// The true values at one row, if they are known.
struct TruthAtRow {
  Quat lab_from_body = Quat::Identity();
  std::optional<Vec3> rate_body_rad_s;
};
using TruthTrack = std::vector<std::optional<TruthAtRow>>;

// Normalised error squared, e P⁻¹ e, of the attitude and, if it is known, the rate. Its expectation
// is `numbers`.
struct NormalisedError {
  double chi2 = 0.0;
  int numbers = 0;
};
NormalisedError normalised_error(const AttitudeEstimate& estimate, const TruthAtRow& truth);
// Angle between estimated and true attitude.
double attitude_error_rad(const AttitudeEstimate& estimate, const TruthAtRow& truth);

// The 95 % interval of a chi-square variable, between its 2.5 % and 97.5 % quantiles, by E. Wilson
// and M. Hilferty (PNAS 17 (1931) 684): accurate to 1 % from two degrees of freedom on.
struct Band {
  double low = 0.0, high = 0.0;
  bool holds(double x) const { return low <= x && x <= high; }
};
Band chi2_band_95(double freedom);

// The errors of one run; NaN if the true values are unknown.
struct RunErrors {
  double rms_attitude_rad = 0.0, rms_rate_rad_s = 0.0;
  double mean_nees = 0.0;     // NEES per degree of freedom
  double part_in_band = 0.0;  // fraction of rows in the 95 % band
  size_t rows = 0;
};
// Errors of the rows from `from` on.
RunErrors run_errors(const std::vector<AttitudeEstimate>& estimates, const TruthTrack& truth,
                     size_t from = 0);

// Errors of many runs of the same length, row by row.
struct RunEnsemble {
  size_t runs = 0;
  // Mean over the runs of the normalised error squared, and root-mean-square attitude error.
  struct Rows {
    std::vector<double> nees, rms_rad;
  };
  Rows filtered, smoothed;
  Band band;  // the 95 % interval of these means
  InnovationSum attitude, gyro;

  // Fraction of the rows from `from` on whose mean is in the band.
  double part_in_band(const Rows& rows, size_t from) const;
};
RunEnsemble ensemble_of(const std::vector<std::pair<Estimation, TruthTrack>>& runs);

// The 95 % interval of InnovationSum::per_number().
Band innovation_band(const InnovationSum& sum);

}  // namespace photorque
