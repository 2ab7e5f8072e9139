// Files that describe a luminaire by its intensity: IES LM-63, IES TM-33 and EULUMDAT.
//
// Candela mean little to this program: at 730 nm the luminous efficiency is 5e-4, and a file seldom
// says of which spectrum it speaks. Only the shape of the intensity is used; radiant power comes
// from the experiment.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sources/profiles/intensity_table.h"

namespace photorque {

// The luminous opening, in the plane across the beam.
struct Opening {
  enum class Shape { point, rectangle, ellipse };
  Shape shape = Shape::point;
  double x_m = 0.0, y_m = 0.0;  // full width along the emitter's x and y, ≥ 0
};

struct PhotometricFile {
  std::string format;  // "IESNA:LM-63-2002", "LM-63-1986", "EULUMDAT", "IESTM33-22"
  std::vector<std::pair<std::string, std::string>> labels;  // keyword and text, in order
  // [cd], in TM-33 also [W/sr] or [µmol/(s sr)]; all factors applied
  IntensityTable table;
  std::optional<double> stated_flux_lm;  // nothing: absolute photometry
  double input_power_W = 0.0;            // electrical; 0: not stated
  Opening opening;
  std::vector<std::string> notices;  // what was passed over or repaired, one line each
};

// LM-63 of 1986, 1991, 1995, 2002 and 2019. Types A, B and C; symmetric tables are unfolded to all
// planes. TILT factors say how a lamp dims in a tilted luminaire, not how it shines: they are
// checked and passed over with a notice. `name` is how messages call the file. InputError with the
// line of what is wrong.
PhotometricFile read_ies(const std::string& bytes, const std::string& name);

// Whether these are the lines of such a file: its first says so, or there is a line "TILT=".
bool looks_like_ies(const std::vector<std::string_view>& lines);

// EULUMDAT (.ldt); symmetries 0 to 4 are unfolded, cd/klm become cd with the stated lamp flux.
PhotometricFile read_eulumdat(const std::string& bytes, const std::string& name);

// IES TM-33 (ATLA S001): radiant, photon or luminous intensity of one emitter on a grid of
// directions, types A, B and C; the first of these that the file has. TiltAngles are passed over
// with a notice. InputError with the line of what is wrong.
PhotometricFile read_tm33(const std::string& bytes, const std::string& name);

// Whichever of them the text is.
PhotometricFile read_photometric(const std::string& bytes, const std::string& name);

// LM-63-2019 text that read_ies() turns into the same table, opening, labels, stated flux and input
// power, to the last bit but for angles, which are written in degrees.
std::string write_ies(const PhotometricFile& file);

}  // namespace photorque
