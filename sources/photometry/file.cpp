#include "sources/photometry/file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "core/constants.h"
#include "core/text/format.h"

namespace photorque {
namespace {

// Azimuths in [0, 360) of planes equal to this one by symmetry.
std::vector<double> images_of(double azimuth_deg, PlaneSymmetry symmetry) {
  std::vector<double> images = {azimuth_deg};
  const bool left_right = symmetry == PlaneSymmetry::across_0_180;
  const bool fore_aft = symmetry == PlaneSymmetry::across_90_270;
  const bool both = symmetry == PlaneSymmetry::both;
  if (left_right || both) images.push_back(-azimuth_deg);
  if (fore_aft || both) images.push_back(180.0 - azimuth_deg);
  if (both) images.push_back(180.0 + azimuth_deg);
  for (double& image : images) {
    image -= 360.0 * std::floor(image / 360.0);
    if (image >= 360.0 - 1e-9) image = 0.0;
  }
  return images;
}

// Limits azimuths to two turns: far larger angles would consist of rounding errors.
void require_few_turns(const std::vector<double>& azimuth_deg, const InputLocation& where) {
  constexpr double most_deg = 720.0;
  for (const double angle_deg : azimuth_deg) {
    if (std::abs(angle_deg) <= most_deg) continue;
    throw InputError(where, "horizontal angles", printed("%g", angle_deg),
                     "angles from -720 to 720 degrees");
  }
}

// Types A and B: adds the mirror images of angles that start at 0.
void mirror(std::vector<double>& angles_deg, std::vector<size_t>& from) {
  for (size_t i = 0; i < angles_deg.size(); ++i) from.push_back(i);
  if (angles_deg.front() != 0.0 || angles_deg.size() < 2) return;
  for (size_t i = 1; i < from.size(); i += 2) {
    angles_deg.insert(angles_deg.begin(), -angles_deg[i]);
    from.insert(from.begin(), from[i]);
  }
}

}  // namespace

PlaneSymmetry implied_symmetry(const std::vector<double>& azimuth_deg) {
  const double first = azimuth_deg.front(), last = azimuth_deg.back();
  if (first == 0.0 && last == 90.0) return PlaneSymmetry::both;
  if (first == 0.0 && last == 180.0) return PlaneSymmetry::across_0_180;
  if (first == 90.0 && last == 270.0) return PlaneSymmetry::across_90_270;
  return PlaneSymmetry::none;
}

IntensityTable unfold(const StoredPlanes& stored, PlaneSymmetry symmetry,
                      const InputLocation& where) {
  require_few_turns(stored.azimuth_deg, where);
  const size_t knots = stored.polar_deg.size();
  IntensityTable table;
  for (const double angle_deg : stored.polar_deg) {
    table.polar_rad.push_back(angle_deg == 180.0 ? pi : angle_deg * degree_rad);
  }
  if (stored.azimuth_deg.size() == 1) {
    table.azimuth_rad = {0.0};
    table.intensity = stored.intensity;
    return table;
  }
  std::map<double, size_t> plane_at;  // of several planes at one azimuth the first counts
  for (size_t j = 0; j < stored.azimuth_deg.size(); ++j) {
    for (const double azimuth_deg : images_of(stored.azimuth_deg[j], symmetry)) {
      const auto next = plane_at.lower_bound(azimuth_deg - 1e-6);
      if (next == plane_at.end() || next->first > azimuth_deg + 1e-6) {
        plane_at.emplace(azimuth_deg, j);
      }
    }
  }
  double before_deg = plane_at.rbegin()->first - 360.0;
  for (const auto& [azimuth_deg, plane] : plane_at) {
    if (azimuth_deg - before_deg > 180.0 + 1e-6) {
      throw InputError(where, "horizontal angles",
                       printed("no plane between %g and %g degrees", before_deg, azimuth_deg),
                       "planes all the way round");
    }
    before_deg = azimuth_deg;
    table.azimuth_rad.push_back(azimuth_deg * degree_rad);
    const auto first = stored.intensity.begin() + static_cast<std::ptrdiff_t>(plane * knots);
    table.intensity.insert(table.intensity.end(), first,
                           first + static_cast<std::ptrdiff_t>(knots));
  }
  return table;
}

IntensityTable sideways_table(Pole pole, const StoredPlanes& stored, const InputLocation& where) {
  std::vector<double> vertical_deg = stored.polar_deg, horizontal_deg = stored.azimuth_deg;
  std::vector<size_t> from_v, from_h;
  mirror(vertical_deg, from_v);
  mirror(horizontal_deg, from_h);
  const bool latitude_is_vertical = pole == Pole::vertical;
  const std::vector<double>& latitude = latitude_is_vertical ? vertical_deg : horizontal_deg;
  const std::vector<double>& longitude = latitude_is_vertical ? horizontal_deg : vertical_deg;
  const auto inside = [](const std::vector<double>& a, double limit) {
    return a.size() >= 2 && a.front() >= -limit && a.back() <= limit;
  };
  if (!inside(latitude, 90.0) || !inside(longitude, 179.0)) {
    throw InputError(where, "angles", "a range that types A and B do not have",
                     "at least two angles from -90 to 90 degrees");
  }
  IntensityTable table{pole, {}, {}, false, {}};
  for (size_t i = latitude.size(); i-- > 0;) {
    table.polar_rad.push_back((90.0 - latitude[i]) * degree_rad);
  }
  for (size_t j = 0; j < longitude.size(); ++j) {
    table.azimuth_rad.push_back(longitude[j] * degree_rad);
    for (size_t i = latitude.size(); i-- > 0;) {
      const size_t v = latitude_is_vertical ? from_v[i] : from_v[j];
      const size_t h = latitude_is_vertical ? from_h[j] : from_h[i];
      table.intensity.push_back(stored.intensity[h * stored.polar_deg.size() + v]);
    }
  }
  return table;
}

void require_goniometer_range(const std::vector<double>& polar_deg, const InputLocation& where) {
  if (polar_deg.front() >= 0.0 && polar_deg.back() <= 180.0) return;
  throw InputError(where, "vertical angles",
                   printed("%g to %g", polar_deg.front(), polar_deg.back()),
                   "angles from 0 to 180 degrees");
}

void require_ascending(const std::vector<double>& angles_deg, const std::string& key,
                       const InputLocation& where) {
  const auto falls = std::ranges::adjacent_find(angles_deg, std::greater_equal());
  if (falls == angles_deg.end()) return;
  throw InputError(where, key, printed("%g after %g", *(falls + 1), *falls),
                   "angles in rising order");
}

void require_opening(const Opening& opening, const InputLocation& where) {
  for (const double side_m : {opening.x_m, opening.y_m}) {
    if (side_m <= largest_extent_m) continue;
    throw InputError(where, "luminous opening", printed("%g m", side_m), "at most 1e9 m");
  }
}

void note_gaps(PhotometricFile& file) {
  const std::vector<double>& at_rad = file.table.azimuth_rad;
  if (file.table.pole != Pole::beam || at_rad.size() < 3) return;
  std::vector<double> gaps_rad;
  for (size_t j = 0; j < at_rad.size(); ++j) {
    const double next = j + 1 < at_rad.size() ? at_rad[j + 1] : at_rad.front() + 2.0 * pi;
    gaps_rad.push_back(next - at_rad[j]);
  }
  std::vector<double> sorted = gaps_rad;
  std::ranges::sort(sorted);
  constexpr double usual_gaps = 2.5, wide_rad = 0.25 * pi;
  const double usual_rad = sorted[(sorted.size() - 1) / 2];
  for (size_t j = 0; j < at_rad.size(); ++j) {
    if (gaps_rad[j] < wide_rad + 1e-9 || gaps_rad[j] < usual_gaps * usual_rad) continue;
    file.notices.push_back(printed(
        "no plane between %g and %g degrees: intensities there lie on straight lines between these "
        "two",
        at_rad[j] / degree_rad, (at_rad[j] + gaps_rad[j]) / degree_rad));
  }
}

void require_light(PhotometricFile& file, const InputLocation& where) {
  size_t negative = 0;
  double least = 0.0, largest = 0.0;
  for (double& value : file.table.intensity) {
    largest = std::max(largest, value);
    if (value >= 0.0) continue;
    ++negative;
    least = std::min(least, value);
    value = 0.0;
  }
  // Within these limits squares and sums neither overflow nor underflow.
  constexpr double faintest_cd = 1e-60, brightest_cd = 1e60;
  if (!(largest > 0.0)) {
    throw InputError(where, "intensities", "none above zero", "a source that shines");
  }
  if (!(largest >= faintest_cd && largest <= brightest_cd)) {
    throw InputError(where, "intensities", printed("%g as the largest", largest), "1e-60 to 1e60");
  }
  if (negative > 0) {
    file.notices.push_back(
        printed("%zu negative intensities, down to %g, count as zero", negative, least));
  }
}

}  // namespace photorque
