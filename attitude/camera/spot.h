// The image of one marker: electrons in pixels, their information on its place, and its readout.
//
// A spot is a Gaussian, smeared evenly along its motion during the exposure and integrated over
// each pixel. Pixels hold Poisson numbers of electrons with Gaussian read noise.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "attitude/camera/tracking_camera.h"

namespace photorque {

using Mat2 = Eigen::Matrix2d;

struct Spot {
  Vec2 centre_px = Vec2::Zero();  // middle of the pixel at column 0, row 0 is (0, 0)
  double electrons = 0.0;
  double sigma_px = 1.0;
  Vec2 smear_px = Vec2::Zero();
};
Spot spot_of(const TrackingCamera& camera, const MarkerView& view);

// Expected electrons in the brightest pixel, of a spot in the middle of that pixel.
double brightest_pixel(const Spot& spot);

// The noise of a pixel.
struct PixelNoise {
  double background_electrons = 0.0;
  double read_noise_electrons = 0.0;
  double full_well_electrons = 1e300;
};
PixelNoise pixel_noise(const TrackingCamera& camera);

// Covariance of the centre [pixel²] that no unbiased reading of the spot can undercut, brightness
// unknown: the inverse of Fisher's information with variance signal + background + read noise²
// (H. Van Trees, Detection, Estimation, and Modulation Theory I, sec. 2.4).
Mat2 centre_covariance_px2(const Spot& spot, const PixelNoise& noise);

// Pixels around a spot.
struct PixelWindow {
  int column = 0, row = 0;  // of its first pixel
  int columns = 0, rows = 0;
  std::vector<double> electrons;  // row by row, the mean background taken off
};

// An exposure. Every number is a hash of the seed and these counters.
PixelWindow expose(const Spot& spot, const PixelNoise& noise, uint64_t seed, uint64_t image,
                   uint64_t marker);

// The centre of the spot in a window, by Fisher scoring of place and brightness from a first centre
// of gravity; nothing where it does not settle inside the window. `shape` says how wide the spot is
// and how it is smeared.
std::optional<Spot> read_spot(const PixelWindow& window, const Spot& shape,
                              const PixelNoise& noise);

}  // namespace photorque
