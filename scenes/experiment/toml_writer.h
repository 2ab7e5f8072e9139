// Settings as TOML text.
#pragma once

#include <string>

#include "core/settings/settings.h"

namespace photorque {

// One value on one line, tables inline. Real numbers read back as the same doubles.
std::string toml_value(const SettingsNode& node);

// A whole document: a table's own values first, then its tables and arrays of tables as sections;
// what lies deeper stands inline.
std::string toml_document(const SettingsNode::Table& root);

}  // namespace photorque
