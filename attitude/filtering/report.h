// The tables and plots of `estimate`.
#pragma once

#include "attitude/filtering/study.h"

namespace photorque {

double in_arcsec(double rad);
// Root of the mean square of the predicted attitude errors.
double rms_sigma_rad(const std::vector<AttitudeEstimate>& estimates);
// The first row that counts in error statistics: earlier rows depend mainly on the first attitude.
size_t settled_row(size_t rows);
// Interval of rows with which a plot has a few thousand points.
size_t thinning(size_t rows);

Table methods_table(const std::vector<Ingredients>& methods, const TruthTrack& truth);
// Errors over time, against the truth or, without it, as predicted.
Plot methods_plot(const std::vector<Ingredients>& methods, const TruthTrack& truth);
Table parameter_table(const Estimation& estimation);
Table estimate_table(const Estimation& estimation);

}  // namespace photorque
