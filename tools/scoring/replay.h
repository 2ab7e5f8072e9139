// How well a propagated model repeats what was recorded.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace photorque {

// The camera's noise about lab x, y and z as a diagnosis used it: what it found ("noise_level" of
// its instruments) in the place of what is stated.
std::array<double, 3> found_noise_arcsec(const nlohmann::json& diagnosis,
                                         std::array<double, 3> stated);

// Squared deviations of the recorded attitudes from the propagated ones about lab x, y and z, in
// units of `noise_arcsec`: of each axis the median, over that of a normal distribution, so that
// outliers do not count; the mean of the three. NaN where the files share no attitudes. InputError
// for files that cannot be read.
double replayed_chi2(const std::filesystem::path& recorded, const std::filesystem::path& propagated,
                     const std::array<double, 3>& noise_arcsec);

}  // namespace photorque
