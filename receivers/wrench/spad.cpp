#include "receivers/wrench/spad.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"

namespace photorque {
namespace {

bool is_whole_sphere(const WrenchTable& table) {
  const auto spans = [](const std::vector<double>& axis_rad, double half_turn_rad) {
    const double step = 2 * half_turn_rad / static_cast<double>(axis_rad.size() - 1);
    for (size_t i = 0; i < axis_rad.size(); ++i) {
      const double expected = -half_turn_rad + static_cast<double>(i) * step;
      if (std::abs(axis_rad[i] - expected) > 1e-9) return false;
    }
    return axis_rad.size() > 1;
  };
  return table.angles == WrenchTable::Angles::azimuth_elevation && spans(table.around_rad, pi) &&
         spans(table.polar_rad, pi / 2);
}

// Header values must not contain line breaks or a second colon.
std::string header_value(std::string text) {
  std::replace(text.begin(), text.end(), ':', '=');
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

std::string motion_text(int number, const char* name, double half_turn_deg, size_t nodes) {
  return printed(
      "Motion    : %d\n  Name    : %s\n  Method  : Step\n  Minimum : %.0f\n"
      "  Maximum : %.0f\n  Step    : %.12g\n",
      number, name, -half_turn_deg, half_turn_deg,
      2 * half_turn_deg / static_cast<double>(nodes - 1));
}

std::string row_text(const WrenchTable& table, size_t around, size_t polar, bool has_torque) {
  const Vec3& f = table.force_body_N[table.node(around, polar)];
  const Vec3& t = table.torque_body_N_m[table.node(around, polar)];
  std::string text =
      printed(" %16.12g %16.12g %19.12e %19.12e %19.12e", table.around_rad[around] / degree_rad,
              table.polar_rad[polar] / degree_rad, f.x(), f.y(), f.z());
  if (has_torque) {
    text += printed(" %19.12e %19.12e %19.12e %19.12e %19.12e", f.norm(), t.x(), t.y(), t.z(),
                    t.norm());
  }
  return text + "\n";
}

}  // namespace

std::string format_spad(const SpadFile& file, const std::string& provenance) {
  if (!is_whole_sphere(file.table)) {
    throw InputError({}, "wrench table", "other angles",
                     "azimuths from -180 to 180 deg and elevations from -90 to 90 deg in even "
                     "steps, for a SPAD file");
  }
  const WrenchTable table = single_valued(file.table);
  std::ostringstream text;
  text.precision(12);
  text << "Version            : 4.22\nSystem             : " << header_value(file.system)
       << "\nAnalysis Type      : Area\nPressure           : 1\nCenter of Mass     :  ("
       << table.about_body_m.x() << ", " << table.about_body_m.y() << ", " << table.about_body_m.z()
       << ")\nGenerator          : " << header_value(provenance) << "\n\n"
       << motion_text(1, "Azimuth", 180.0, table.around_rad.size())
       << motion_text(2, "Elevation", 90.0, table.polar_rad.size())
       << ": END\n\nRecord count       : " << table.nodes() << "\n\n";
  text << " Azimuth Elevation Force(X) Force(Y) Force(Z)"
       << (file.has_torque ? " Force(T) Torque(X) Torque(Y) Torque(Z) Torque(T)\n" : "\n")
       << " degrees degrees m^2 m^2 m^2" << (file.has_torque ? " m^2 m^3 m^3 m^3 m^3\n" : "\n");
  const std::string dashes = std::string(file.has_torque ? 194 : 94, '-') + "\n";
  text << dashes;
  for (size_t around = 0; around < table.around_rad.size(); ++around) {
    for (size_t polar = 0; polar < table.polar_rad.size(); ++polar) {
      text << row_text(table, around, polar, file.has_torque);
    }
  }
  text << dashes;
  return text.str();
}

}  // namespace photorque
