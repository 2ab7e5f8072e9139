// A lamp with the measured intensity of a table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "raytrace/emitter.h"
#include "sources/photometry/file.h"
#include "sources/profiles/tabulated_intensity.h"

namespace photorque {

// Light from a flat opening at z = 0 whose points all radiate alike, with directions from a table:
// the far-field intensity of a luminaire combined with the extent of its near field.
class PhotometricLamp : public Emitter {
 public:
  // power > 0; the caller checks this.
  PhotometricLamp(double power_W, const Opening& opening, TabulatedIntensity intensity);

  double power_W() const override { return power_W_; }
  void emit(const SampleBlock& samples, RayBlock& rays) const override;
  double relative_intensity(double angle_rad) const override;

  const TabulatedIntensity& intensity() const { return intensity_; }
  const Opening& opening() const { return opening_; }

 private:
  double round_average(double angle_rad) const;

  double power_W_;
  Opening opening_;
  TabulatedIntensity intensity_;
  // Averages around the beam at equally spaced angles from 0 to π, for tables whose pole is across
  // the beam.
  std::vector<double> average_;
  double largest_average_ = 0.0;
};

// The lamp as an aperture for gathering: a disc whose table is rotationally symmetric about the
// beam and emits forwards only. Empty for other lamps.
std::optional<UniformAperture> uniform_aperture(const PhotometricLamp& lamp);

// One line with the numbers and a sufficient spacing, if the angles of a table are coarse: its flux
// depends on the interpolation by more than 0.2 %. Empty otherwise.
std::optional<std::string> coarseness_notice(const PhotometricLamp& lamp);

}  // namespace photorque
