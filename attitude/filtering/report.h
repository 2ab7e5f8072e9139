// The tables and plots of `estimate`.
#pragma once

#include "attitude/filtering/study.h"

namespace photorque {

// Converts an angle from rad to arcsec.
double in_arcsec(double rad);
// Root of the mean square of the predicted attitude errors.
double rms_sigma_rad(const std::vector<AttitudeEstimate>& estimates);
// The first row of error statistics: earlier rows depend mainly on the first attitude.
size_t settled_row(size_t rows);
// Row interval for plots with a few thousand points.
size_t thinning(size_t rows);

// Errors of filter and smoother for every method, NaN without truth.
Table methods_table(const std::vector<Ingredients>& methods, const TruthTrack& truth);
// Errors as functions of time, relative to the truth or, without it, as predicted.
Plot methods_plot(const std::vector<Ingredients>& methods, const TruthTrack& truth);
// Parameters before and after the estimation, with sigmas.
Table parameter_table(const Estimation& estimation);
// Attitude, rate and their sigmas, filtered and smoothed.
Table estimate_table(const Estimation& estimation);

}  // namespace photorque
