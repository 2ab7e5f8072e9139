#include <algorithm>
#include <array>

#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "scenes/surfaces/settings.h"

namespace photorque {
namespace {

constexpr std::array<std::string_view, 4> brdf_columns = {"incidence_deg", "scatter_deg",
                                                          "azimuth_deg", "brdf_1_sr"};
constexpr std::array<double, 4> brdf_column_limits = {90.0, 90.0, 180.0, 1e9};
constexpr size_t max_brdf_rows = 1'000'000;

struct BrdfRow {
  std::array<double, 4> values;  // in the order of brdf_columns
  int line;
};

// Position of each of brdf_columns in the header.
std::array<size_t, 4> read_header(const std::vector<std::string_view>& fields,
                                  const InputLocation& where) {
  std::array<size_t, 4> places{};
  for (size_t c = 0; c < brdf_columns.size(); ++c) {
    const auto found = std::find(fields.begin(), fields.end(), brdf_columns[c]);
    if (found == fields.end()) {
      throw InputError(where, std::string(brdf_columns[c]), "no such column",
                       "a header with incidence_deg, scatter_deg, azimuth_deg and brdf_1_sr");
    }
    places[c] = static_cast<size_t>(found - fields.begin());
  }
  return places;
}

std::vector<BrdfRow> read_rows(const std::string& text, const std::string& name) {
  std::vector<BrdfRow> rows;
  std::optional<std::array<size_t, 4>> places;
  size_t width = 0;
  DataLines lines(text, name);
  for (std::string_view line; lines.next(line);) {
    const InputLocation& where = lines.where();
    const std::vector<std::string_view> fields = cells_of(line);
    if (!places) {
      places = read_header(fields, where);
      width = fields.size();
      continue;
    }
    if (fields.size() != width) {
      throw InputError(where, "", std::to_string(fields.size()) + " fields",
                       std::to_string(width) + ", as in the header");
    }
    if (rows.size() == max_brdf_rows) {
      throw InputError(where, "", "more than a million rows", "a smaller table");
    }
    BrdfRow row{{}, where.line};
    for (size_t c = 0; c < row.values.size(); ++c) {
      const std::string_view field = fields[(*places)[c]];
      const std::optional<double> number = number_in(field);
      if (!number || *number < 0.0 || *number > brdf_column_limits[c]) {
        throw InputError(where, std::string(brdf_columns[c]), in_quotes(field),
                         "a number from 0 to " + shortest(brdf_column_limits[c]));
      }
      row.values[c] = *number;
    }
    rows.push_back(row);
  }
  if (rows.empty()) throw InputError({name}, "", "no rows", "a table of measured scattering");
  return rows;
}

std::vector<double> distinct(const std::vector<BrdfRow>& rows, size_t column) {
  std::vector<double> values;
  for (const BrdfRow& row : rows) values.push_back(row.values[column]);
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

size_t place_of(const std::vector<double>& values, double value) {
  return static_cast<size_t>(std::lower_bound(values.begin(), values.end(), value) -
                             values.begin());
}

std::vector<double> in_radians(std::vector<double> degrees) {
  for (double& value : degrees) value *= degree_rad;
  return degrees;
}

std::string describe_angles(const std::array<std::vector<double>, 3>& axes, size_t index) {
  const size_t azimuths = axes[2].size(), scatters = axes[1].size();
  return "incidence " + shortest(axes[0][index / azimuths / scatters]) + ", scatter " +
         shortest(axes[1][index / azimuths % scatters]) + ", azimuth " +
         shortest(axes[2][index % azimuths]) + " deg";
}

}  // namespace

BrdfTable read_brdf(const std::string& text, const std::string& name) {
  const std::vector<BrdfRow> rows = read_rows(text, name);
  const std::array<std::vector<double>, 3> axes = {distinct(rows, 0), distinct(rows, 1),
                                                   distinct(rows, 2)};
  const size_t entries = axes[0].size() * axes[1].size() * axes[2].size();
  // A complete table has as many rows as combinations of angles. This is checked first, so that
  // scattered angles do not cause a large allocation.
  if (entries > 2 * max_brdf_rows) {
    throw InputError({name}, "",
                     std::to_string(rows.size()) + " rows of " + std::to_string(entries) +
                         " combinations of their angles",
                     "every incidence with every scatter and azimuth");
  }
  BrdfTable table{in_radians(axes[0]), in_radians(axes[1]), in_radians(axes[2]),
                  std::vector<double>(entries, -1.0)};
  for (const BrdfRow& row : rows) {
    double& entry = table.at(place_of(axes[0], row.values[0]), place_of(axes[1], row.values[1]),
                             place_of(axes[2], row.values[2]));
    if (entry >= 0.0) {
      throw InputError({name, row.line}, "", "angles that an earlier row has", "each once");
    }
    entry = row.values[3];
  }
  const auto missing = std::find(table.brdf_1_sr.begin(), table.brdf_1_sr.end(), -1.0);
  if (missing != table.brdf_1_sr.end()) {
    const auto index = static_cast<size_t>(missing - table.brdf_1_sr.begin());
    throw InputError({name}, "", "no row for " + describe_angles(axes, index),
                     "every incidence with every scatter and azimuth");
  }
  return table;
}

std::optional<std::string> coverage_notice(const BrdfTable& table) {
  constexpr double wide_rad = 45.0 * degree_rad;
  const double incidence_rad = table.incidence_rad.back(), scatter_rad = table.scatter_rad.back();
  const bool is_constant = table.brdf_1_sr.size() == 1;
  if (is_constant || std::min(incidence_rad, scatter_rad) >= wide_rad) return std::nullopt;
  std::string words = printed(
      "measured up to an incidence of %.3g deg and a scatter of %.3g deg; to 90 deg the last "
      "values go on",
      incidence_rad / degree_rad, scatter_rad / degree_rad);
  // Detects tables in radians: they have no angle above π/2.
  constexpr double right_angle = pi / 2.0 + 1e-2;
  const double widest = std::max(incidence_rad, scatter_rad) / degree_rad;
  const double azimuth = table.azimuth_rad.back() / degree_rad;
  if (widest > 0.0 && widest <= right_angle && azimuth <= pi + 1e-2) {
    words += " (are its angles in radians?)";
  }
  return words;
}

}  // namespace photorque
