// What the readers of photometric files share: symmetric tables unfolded, and the checks that every
// table must pass.
#pragma once

#include <string>
#include <vector>

#include "core/errors.h"
#include "sources/photometric_file.h"

namespace photorque {

// Which planes a file stands for beside those that it stores.
enum class PlaneSymmetry {
  none,
  across_0_180,   // left equals right of the plane through 0 and 180 degrees
  across_90_270,  // of the plane through 90 and 270 degrees
  both,
};

// Planes as stored: azimuths in degrees, [plane][polar].
struct StoredPlanes {
  std::vector<double> azimuth_deg;
  std::vector<double> polar_deg;  // from the pole
  std::vector<double> intensity;
};

// All planes round the beam, from those stored and their mirror images; a single plane stays alone
// and stands for all. Throws InputError at `where` when planes leave more than half a turn out.
IntensityTable unfold(const StoredPlanes& stored, PlaneSymmetry symmetry,
                      const InputLocation& where);

// Throws InputError unless angles ascend strictly.
void require_ascending(const std::vector<double>& angles_deg, const std::string& key,
                       const InputLocation& where);

// Negative intensities, the noise of goniometers, become zero with a notice. Throws InputError when
// nothing shines.
void require_light(PhotometricFile& file, const InputLocation& where);

}  // namespace photorque
