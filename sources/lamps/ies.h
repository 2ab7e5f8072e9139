// A lamp with the measured intensity of a table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "raytrace/emitter.h"
#include "sources/photometry/file.h"
#include "sources/profiles/tabulated_intensity.h"

namespace photorque {

// Light from every point of a flat opening at z = 0 alike, with directions from a table: the far
// field of a luminaire on the extent of its near field.
class PhotometricLamp : public Emitter {
 public:
  // power > 0; the caller checks.
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
  // Averages round the beam at even angles from 0 to π, of tables whose pole is across the beam.
  std::vector<double> average_;
  double largest_average_ = 0.0;
};

// The lamp as an aperture that light can be gathered from: a disc whose table is the same all round
// the beam and shines forwards only; nothing for others.
std::optional<UniformAperture> uniform_aperture(const PhotometricLamp& lamp);

// One line when the angles of a table are so far apart that its flux depends on how it is read
// between them by more than 0.2 %: with the numbers, and the spacing that would do.
std::optional<std::string> coarseness_notice(const PhotometricLamp& lamp);

}  // namespace photorque
