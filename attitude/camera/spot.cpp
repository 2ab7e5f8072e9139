#include "attitude/camera/spot.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "core/constants.h"
#include "core/numerics/random.h"

namespace photorque {
namespace {

// Fraction of a Gaussian within a pixel whose centre is at a distance of `from_centre`, and its
// derivative with respect to the centre of the Gaussian.
struct Slice {
  double part, slope;
};
Slice slice_of(double from_centre, double sigma) {
  const double low = (from_centre - 0.5) / sigma, high = (from_centre + 0.5) / sigma;
  const double part = 0.5 * (std::erf(high / std::sqrt(2.0)) - std::erf(low / std::sqrt(2.0)));
  const double density_low = std::exp(-0.5 * low * low),
               density_high = std::exp(-0.5 * high * high);
  return {part, (density_low - density_high) / (sigma * std::sqrt(2.0 * pi))};
}

// Expected electrons per pixel of a spot of one electron, with derivatives with respect to its
// centre.
struct UnitSpot {
  std::vector<double> part, by_column, by_row;
};
UnitSpot unit_spot(const Spot& spot, const PixelWindow& window) {
  const auto columns = static_cast<size_t>(window.columns);
  const auto rows = static_cast<size_t>(window.rows);
  UnitSpot unit;
  unit.part.assign(columns * rows, 0.0);
  unit.by_column = unit.by_row = unit.part;
  // Gaussians at intervals of half their sigma give a uniform line to 1e-8.
  const int steps = 1 + static_cast<int>(std::ceil(2.0 * spot.smear_px.norm() / spot.sigma_px));
  std::vector<Slice> across(columns), down(rows);
  for (int step = 0; step < steps; ++step) {
    const Vec2 centre = spot.centre_px + ((step + 0.5) / steps - 0.5) * spot.smear_px;
    for (size_t c = 0; c < columns; ++c) {
      across[c] = slice_of(window.column + static_cast<int>(c) - centre.x(), spot.sigma_px);
    }
    for (size_t r = 0; r < rows; ++r) {
      down[r] = slice_of(window.row + static_cast<int>(r) - centre.y(), spot.sigma_px);
    }
    for (size_t r = 0; r < rows; ++r) {
      for (size_t c = 0; c < columns; ++c) {
        const size_t i = r * columns + c;
        unit.part[i] += across[c].part * down[r].part / steps;
        unit.by_column[i] += across[c].slope * down[r].part / steps;
        unit.by_row[i] += across[c].part * down[r].slope / steps;
      }
    }
  }
  return unit;
}

// Pixels that contain all but 1e-5 of the spot.
PixelWindow window_around(const Spot& spot) {
  const double half_x = 4.5 * spot.sigma_px + 0.5 * std::abs(spot.smear_px.x());
  const double half_y = 4.5 * spot.sigma_px + 0.5 * std::abs(spot.smear_px.y());
  PixelWindow window;
  window.column = static_cast<int>(std::lround(spot.centre_px.x() - half_x));
  window.row = static_cast<int>(std::lround(spot.centre_px.y() - half_y));
  window.columns = static_cast<int>(std::lround(spot.centre_px.x() + half_x)) - window.column + 1;
  window.rows = static_cast<int>(std::lround(spot.centre_px.y() + half_y)) - window.row + 1;
  return window;
}

double variance_of(double signal, const PixelNoise& noise) {
  return std::max(signal, 0.0) + noise.background_electrons +
         noise.read_noise_electrons * noise.read_noise_electrons;
}

// Fisher's information on column, row and brightness of the spot, and the score of the readings.
struct Score {
  Mat3 information = Mat3::Zero();
  Vec3 score = Vec3::Zero();
};
Score score_of(const Spot& spot, const PixelNoise& noise, const PixelWindow& window) {
  const UnitSpot unit = unit_spot(spot, window);
  Score sum;
  for (size_t i = 0; i < unit.part.size(); ++i) {
    const double expected = spot.electrons * unit.part[i];
    const Vec3 gradient(spot.electrons * unit.by_column[i], spot.electrons * unit.by_row[i],
                        unit.part[i]);
    const double variance = variance_of(expected, noise);
    sum.information += gradient * gradient.transpose() / variance;
    if (!window.electrons.empty()) {
      sum.score += gradient * (window.electrons[i] - expected) / variance;
    }
  }
  return sum;
}

// Random 64-bit numbers for the distributions of the standard library.
class HashedBits {
 public:
  using result_type = uint64_t;
  explicit HashedBits(uint64_t stream) : stream_(stream) {}
  static constexpr uint64_t min() { return 0; }
  static constexpr uint64_t max() { return ~uint64_t{0}; }
  uint64_t operator()() { return hash_words(stream_, next_++); }

 private:
  uint64_t stream_, next_ = 0;
};

}  // namespace

Spot spot_of(const TrackingCamera& camera, const MarkerView& view) {
  // The left edge of column 0 is at minus half the width.
  const Vec2 centre_px = view.pixel + 0.5 * Vec2(camera.width - 1.0, camera.height - 1.0);
  return {centre_px, view.electrons, spot_sigma_px(camera), view.smear_px};
}

double brightest_pixel(const Spot& spot) {
  Spot centred = spot;
  centred.centre_px.setZero();
  return spot.electrons * unit_spot(centred, {0, 0, 1, 1, {}}).part[0];
}

PixelNoise pixel_noise(const TrackingCamera& camera) {
  return {camera.background_electrons, camera.read_noise_electrons, camera.full_well_electrons};
}

Mat2 centre_covariance_px2(const Spot& spot, const PixelNoise& noise) {
  const Mat3 information = score_of(spot, noise, window_around(spot)).information;
  return information.ldlt().solve(Mat3::Identity()).topLeftCorner<2, 2>();
}

PixelWindow expose(const Spot& spot, const PixelNoise& noise, uint64_t seed, uint64_t image,
                   uint64_t marker) {
  PixelWindow window = window_around(spot);
  const UnitSpot unit = unit_spot(spot, window);
  HashedBits bits(hash_words(seed, image, marker));
  std::normal_distribution<double> normal;
  for (const double part : unit.part) {
    const double expected = spot.electrons * part + noise.background_electrons;
    double electrons = 0.0;
    if (expected > 0.0) {
      electrons = static_cast<double>(std::poisson_distribution<int64_t>(expected)(bits));
    }
    electrons += noise.read_noise_electrons * normal(bits);
    window.electrons.push_back(std::min(electrons, noise.full_well_electrons) -
                               noise.background_electrons);
  }
  return window;
}

std::optional<Spot> read_spot(const PixelWindow& window, const Spot& shape,
                              const PixelNoise& noise) {
  // The start follows from pixels above the noise.
  const double threshold = 2.0 * std::sqrt(variance_of(0.0, noise));
  Spot spot = shape;
  double sum = 0.0;
  Vec2 moment = Vec2::Zero();
  for (int i = 0; i < window.columns * window.rows; ++i) {
    const double electrons = window.electrons[static_cast<size_t>(i)];
    if (electrons < threshold) continue;
    sum += electrons;
    moment += electrons * Vec2(window.column + i % window.columns, window.row + i / window.columns);
  }
  if (!(sum > 0.0)) return {};
  spot.centre_px = moment / sum;
  spot.electrons = sum;
  constexpr int rounds = 20;
  constexpr double settled_px = 1e-7;
  for (int round = 0; round < rounds; ++round) {
    const Score now = score_of(spot, noise, window);
    Vec3 step = now.information.ldlt().solve(now.score);
    // Limits the step, so that the spot stays in its window after a poor start.
    const double longest = std::max(std::abs(step.x()), std::abs(step.y()));
    if (longest > 1.0) step.head<2>() /= longest;
    spot.centre_px += step.head<2>();
    spot.electrons = std::max(spot.electrons + step.z(), 1.0);
    const Vec2 inside = spot.centre_px - Vec2(window.column, window.row);
    if (!(inside.minCoeff() > -0.5 && inside.x() < window.columns && inside.y() < window.rows)) {
      return {};
    }
    if (longest < settled_px) return spot;
  }
  return {};
}

}  // namespace photorque
