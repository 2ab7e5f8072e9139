// Numbers of an experiment that are known to within an error: { value = …, sigma = … }.
//
// Any number of lamps, array and attitude may have this form. A run uses the value. A diagnosis of
// light also uses the error as a Gaussian prior.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

struct UncertainKey {
  std::string path;                  // as apply_override() reads it: "source[0].power_W"
  std::vector<double> value, sigma;  // in the unit of the key
  bool is_array = false;             // those of an array, else one number
};

// Those of an experiment's text with its overrides.
std::vector<UncertainKey> uncertain_keys(const std::filesystem::path& path, const std::string& text,
                                         std::span<const std::string> overrides);

// Puts the value in the place of every such pair in [[source]], [array] and [attitude], and returns
// what was there, in the order of the keys' names. InputError for a sigma that is negative, or
// of another size than its value.
std::vector<UncertainKey> take_uncertainty(SettingsNode& root);

}  // namespace photorque
