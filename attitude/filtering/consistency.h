// Whether a filter's errors agree with its predicted errors.
//
// Source: Y. Bar-Shalom, X. Li, T. Kirubarajan, Estimation with Applications to Tracking and
// Navigation (2001), sec. 5.4: normalised errors squared (NEES) and innovations squared (NIS).
#pragma once

#include <optional>
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
class RunEnsemble {
 public:
  void add(const Estimation& estimation, const TruthTrack& truth);

  int runs() const { return runs_; }
  // Mean over the runs of the normalised error squared, for filter and smoother.
  std::vector<double> nees_filtered() const { return mean_of(chi2_filtered_); }
  std::vector<double> nees_smoothed() const { return mean_of(chi2_smoothed_); }
  // The 95 % interval of these means.
  Band band() const;
  // Fraction of the rows from `from` on whose mean is in the band.
  double part_in_band(const std::vector<double>& nees, size_t from) const;
  // Root-mean-square attitude errors over the runs [rad].
  std::vector<double> rms_filtered_rad() const { return rms_of(square_filtered_); }
  std::vector<double> rms_smoothed_rad() const { return rms_of(square_smoothed_); }
  const InnovationSum& attitude() const { return attitude_; }
  const InnovationSum& gyro() const { return gyro_; }

 private:
  std::vector<double> mean_of(std::vector<double> sums) const;
  std::vector<double> rms_of(const std::vector<double>& squares) const;

  int runs_ = 0;
  int numbers_ = 6;
  std::vector<double> chi2_filtered_, chi2_smoothed_, square_filtered_, square_smoothed_;
  InnovationSum attitude_, gyro_;
};

// The 95 % interval of InnovationSum::per_number().
Band innovation_band(const InnovationSum& sum);

}  // namespace photorque
