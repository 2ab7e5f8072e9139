// What settings.cpp and values.cpp have in common.
#pragma once

#include <map>
#include <set>
#include <string>

#include "core/settings/settings.h"

namespace photorque {

// What was read and what was asked for: shared by all views of one root, so that finish() on the
// root sees what every part of the program did.
struct Settings::Log {
  std::set<const SettingsNode*> read;
  std::map<const SettingsNode*, std::set<std::string>> asked;  // table → keys asked for

  void mark_all(const SettingsNode& node) {
    read.insert(&node);
    if (const auto* array = std::get_if<SettingsNode::Array>(&node.value)) {
      for (const auto& item : *array) mark_all(item);
    } else if (const auto* table = std::get_if<SettingsNode::Table>(&node.value)) {
      for (const auto& [key, item] : *table) mark_all(item);
    }
  }
};

// Twelve significant digits, as people write numbers.
std::string format_setting(double x);

}  // namespace photorque
