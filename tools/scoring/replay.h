// How well a propagated model repeats what was recorded.
#pragma once

#include <array>
#include <filesystem>

namespace photorque {

// Squared deviations of the recorded attitudes from the propagated ones about lab x, y and z, in
// units of `noise_arcsec`: of each axis the median, over that of a normal distribution, so that
// outliers do not count; the mean of the three. NaN where the files share no attitudes. InputError
// for files that cannot be read.
double replayed_chi2(const std::filesystem::path& recorded, const std::filesystem::path& propagated,
                     const std::array<double, 3>& noise_arcsec);

}  // namespace photorque
