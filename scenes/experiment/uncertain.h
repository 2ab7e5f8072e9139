// Numbers of an experiment with a known uncertainty: { value = …, sigma = … }.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/settings/settings.h"

namespace photorque {

// A key whose number is uncertain.
struct UncertainKey {
  std::string path;                  // in the syntax of apply_override(): "source[0].power_W"
  std::vector<double> value, sigma;  // in the unit of the key
  bool is_array = false;             // true: an array; false: one number
};

// A number or an array of numbers; empty for other values.
std::vector<double> plain_numbers(const SettingsNode& node);

// Uncertain keys of an experiment's text with its overrides.
std::vector<UncertainKey> uncertain_keys(const std::filesystem::path& path, const std::string& text,
                                         std::span<const std::string> overrides);

// Replaces every such pair in [[source]], [array] and [attitude] by its value, and returns the
// pairs in the order of the keys' names. Throws InputError for a negative sigma, or one of another
// size than its value.
std::vector<UncertainKey> take_uncertainty(SettingsNode& root);

}  // namespace photorque
