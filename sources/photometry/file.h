// Files that describe a luminaire by its intensity: IES LM-63, IES TM-33 and EULUMDAT.
//
// Luminous units are of little use for this program: at 730 nm the luminous efficiency is 5e-4, and
// a file seldom states its spectrum. Only the shape of the intensity is used; radiant power comes
// from the experiment.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/errors.h"
#include "sources/profiles/tabulated_intensity.h"

namespace photorque {

// Luminous opening, in the plane across the beam.
struct Opening {
  enum class Shape { point, rectangle, ellipse };
  Shape shape = Shape::point;
  double x_m = 0.0, y_m = 0.0;  // full width along the emitter's x and y, ≥ 0
};

struct PhotometricFile {
  std::string format;  // "IESNA:LM-63-2002", "LM-63-1986", "EULUMDAT", "IESTM33-22"
  std::vector<std::pair<std::string, std::string>> labels;  // keyword and text, in order
  // [cd], in TM-33 also [W/sr] or [µmol/(s sr)]; all factors are applied
  IntensityTable table;
  std::optional<double> stated_flux_lm;  // empty: absolute photometry
  double input_power_W = 0.0;            // electrical; 0: not stated
  Opening opening;
  std::vector<std::string> notices;  // parts that were ignored or repaired, one line each
};

// Reads LM-63 of 1986, 1991, 1995, 2002 and 2019, types A, B and C; symmetric tables are unfolded
// to all planes. TILT factors describe the dimming of a lamp in a tilted luminaire; they are
// checked and ignored with a notice. Messages call the file `name`. Throws InputError with the line
// of the error.
PhotometricFile read_ies(const std::string& bytes, const std::string& name);

// Whether the lines are LM-63, judged by the first line or by a line "TILT=".
bool looks_like_ies(const std::vector<std::string_view>& lines);

// Reads EULUMDAT (.ldt). Symmetries 0 to 4 are unfolded; cd/klm is converted to cd with the stated
// lamp flux.
PhotometricFile read_eulumdat(const std::string& bytes, const std::string& name);

// Reads IES TM-33 (ATLA S001): radiant, photon or luminous intensity (the first of these in the
// file) of one emitter on a grid of directions, types A, B and C. TiltAngles are ignored with a
// notice. Throws InputError with the line of the error.
PhotometricFile read_tm33(const std::string& bytes, const std::string& name);

// Detects the format from the text and reads it.
PhotometricFile read_photometric(const std::string& bytes, const std::string& name);

// Functions shared by the readers: unfolding of symmetric tables, and checks of every table.

// Symmetry by which missing planes follow from stored ones.
enum class PlaneSymmetry {
  none,
  across_0_180,   // mirror images about the plane through 0 and 180 degrees
  across_90_270,  // mirror images about the plane through 90 and 270 degrees
  both,
};

// Symmetry that LM-63 implies by the range of planes: 0 to 90, 0 to 180, 90 to 270, or another.
PlaneSymmetry implied_symmetry(const std::vector<double>& azimuth_deg);

// Planes as stored: ascending angles in degrees, intensities [plane][polar].
struct StoredPlanes {
  std::vector<double> azimuth_deg;  // or the horizontal angles of types A and B
  std::vector<double> polar_deg;    // from the beam, or the vertical angles of types A and B
  std::vector<double> intensity;
};

// All planes around the beam, from those stored and their mirror images. A single plane stays
// single and is valid at every azimuth. Throws InputError at `where` if a gap between planes
// exceeds half a turn.
IntensityTable unfold(const StoredPlanes& stored, PlaneSymmetry symmetry,
                      const InputLocation& where);

// Tables of types A (pole `vertical`) and B (`horizontal`): latitude and longitude about an axis
// across the beam, which is at H = V = 0. H counts clockwise seen from above (LM-63-2002,
// definitions). From the beam, V increases towards the emitter's x and H towards its y: upwards and
// to the right for a beam along lab x. Angles that start at 0 are mirrored to both sides.
// Throws InputError at `where` for angles outside the sphere's range.
IntensityTable sideways_table(Pole pole, const StoredPlanes& stored, const InputLocation& where);

// Throws InputError unless ascending polar angles lie in 0 to 180 degrees.
void require_goniometer_range(const std::vector<double>& polar_deg, const InputLocation& where);

// Throws InputError unless the angles ascend strictly.
void require_ascending(const std::vector<double>& angles_deg, const std::string& key,
                       const InputLocation& where);

// Throws InputError for an opening larger than largest_extent_m.
void require_opening(const Opening& opening, const InputLocation& where);

// Adds a notice if planes are far apart, since values between them are interpolated linearly: more
// than an eighth of a turn, and far more than elsewhere.
void note_gaps(PhotometricFile& file);

// Sets negative intensities (noise of goniometers) to zero with a notice. Throws InputError if all
// intensities are zero or if their magnitude cannot be computed with.
void require_light(PhotometricFile& file, const InputLocation& where);

}  // namespace photorque
