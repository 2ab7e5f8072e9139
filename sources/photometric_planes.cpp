#include "sources/photometric_planes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "core/constants.h"

namespace photorque {
namespace {

// Azimuths that show the same plane, in [0, 360).
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

}  // namespace

IntensityTable unfold(const StoredPlanes& stored, PlaneSymmetry symmetry,
                      const InputLocation& where) {
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
  std::map<double, size_t> plane_at;  // the first of planes at one azimuth counts
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
      std::ostringstream gap;
      gap << "no plane between " << before_deg << " and " << azimuth_deg << " degrees";
      throw InputError(where, "horizontal angles", gap.str(), "planes all the way round");
    }
    before_deg = azimuth_deg;
    table.azimuth_rad.push_back(azimuth_deg * degree_rad);
    const auto first = stored.intensity.begin() + static_cast<std::ptrdiff_t>(plane * knots);
    table.intensity.insert(table.intensity.end(), first,
                           first + static_cast<std::ptrdiff_t>(knots));
  }
  return table;
}

void require_ascending(const std::vector<double>& angles_deg, const std::string& key,
                       const InputLocation& where) {
  for (size_t i = 1; i < angles_deg.size(); ++i) {
    if (angles_deg[i] > angles_deg[i - 1]) continue;
    std::ostringstream found;
    found << angles_deg[i] << " after " << angles_deg[i - 1];
    throw InputError(where, key, found.str(), "angles in rising order");
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
  if (!(largest > 0.0)) {
    throw InputError(where, "intensities", "none above zero", "a source that shines");
  }
  if (negative > 0) {
    std::ostringstream line;
    line << negative << " negative intensities, down to " << least << ", count as zero";
    file.notices.push_back(line.str());
  }
}

}  // namespace photorque
