// The image of one marker: electrons in pixels, their information on its position, and the readout.
//
// A spot is a Gaussian that is smeared uniformly along its motion during the exposure and
// integrated over each pixel. Pixels contain Poisson-distributed electrons with Gaussian read
// noise.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "attitude/camera/tracking_camera.h"

namespace photorque {

using Mat2 = Eigen::Matrix2d;

struct Spot {
  Vec2 centre_px = Vec2::Zero();  // (0, 0) is the centre of the pixel in column 0, row 0
  double electrons = 0.0;
  double sigma_px = 1.0;
  Vec2 smear_px = Vec2::Zero();
};
Spot spot_of(const TrackingCamera& camera, const MarkerView& view);

// Expected electrons in the brightest pixel if the spot is at its centre.
double brightest_pixel(const Spot& spot);

// The noise of a pixel.
struct PixelNoise {
  double background_electrons = 0.0;
  double read_noise_electrons = 0.0;
  double full_well_electrons = 1e300;
};
PixelNoise pixel_noise(const TrackingCamera& camera);

// Covariance of the centre [pixel²]: the Cramér–Rao bound for an unknown brightness. It is the
// inverse of Fisher's information with the variance signal + background + read noise² (H. Van
// Trees, Detection, Estimation, and Modulation Theory I, sec. 2.4).
Mat2 centre_covariance_px2(const Spot& spot, const PixelNoise& noise);

// Pixels around a spot.
struct PixelWindow {
  int column = 0, row = 0;  // of its first pixel
  int columns = 0, rows = 0;
  std::vector<double> electrons;  // row by row, minus the mean background
};

// Simulates an exposure. Every random number is a hash of seed, image and marker.
PixelWindow expose(const Spot& spot, const PixelNoise& noise, uint64_t seed, uint64_t image,
                   uint64_t marker);

// The centre of the spot in a window, by Fisher scoring of position and brightness that starts at
// the centre of gravity. `shape` has the width and smear of the spot. nullopt if it does not
// converge inside the window.
std::optional<Spot> read_spot(const PixelWindow& window, const Spot& shape,
                              const PixelNoise& noise);

}  // namespace photorque
