// What the readers of photometric files share: symmetric tables unfolded, and the checks that every
// table must pass.
#pragma once

#include <string>
#include <vector>

#include "core/errors.h"
#include "sources/photometry/file.h"

namespace photorque {

// Which planes a file stands for beside those that it stores.
enum class PlaneSymmetry {
  none,
  across_0_180,   // left equals right of the plane through 0 and 180 degrees
  across_90_270,  // of the plane through 90 and 270 degrees
  both,
};

// What LM-63 says by the range of its planes: 0 to 90, 0 to 180, 90 to 270 or anything else.
PlaneSymmetry implied_symmetry(const std::vector<double>& azimuth_deg);

// Planes as stored: ascending angles in degrees, intensities [plane][polar].
struct StoredPlanes {
  std::vector<double> azimuth_deg;  // or the horizontal angles of types A and B
  std::vector<double> polar_deg;    // from the beam, or the vertical angles of types A and B
  std::vector<double> intensity;
};

// All planes round the beam, from those stored and their mirror images; a single plane stays alone
// and stands for all. Throws InputError at `where` when planes leave more than half a turn out.
IntensityTable unfold(const StoredPlanes& stored, PlaneSymmetry symmetry,
                      const InputLocation& where);

// Types A (pole `vertical`) and B (`horizontal`): latitude and longitude about an axis across the
// beam; angles that start at 0 stand for both sides. Throws InputError at `where` for angles beyond
// a sphere's.
IntensityTable sideways_table(Pole pole, const StoredPlanes& stored, const InputLocation& where);

// Throws InputError unless ascending polar angles lie in 0 to 180 degrees.
void require_goniometer_range(const std::vector<double>& polar_deg, const InputLocation& where);

// Throws InputError unless angles ascend strictly.
void require_ascending(const std::vector<double>& angles_deg, const std::string& key,
                       const InputLocation& where);

// Throws InputError for an opening larger than largest_extent_m.
void require_opening(const Opening& opening, const InputLocation& where);

// A notice where planes stand far apart round the beam, which in between are joined by straight
// lines: more than an eighth of a turn, and far more than elsewhere.
void note_gaps(PhotometricFile& file);

// Negative intensities, the noise of goniometers, become zero with a notice. Throws InputError when
// nothing shines, or nothing that can be computed with.
void require_light(PhotometricFile& file, const InputLocation& where);

}  // namespace photorque
