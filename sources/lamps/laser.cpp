// A TEM00 laser beam as rays.
//
// The rays are drawn from the Wigner distribution of the beam. Position in the waist and transverse
// slope are independent Gaussians with the standard deviations w0/2 and tan Θ/2 along each axis; w0
// is the 1/e² radius of the waist, Θ the 1/e² half angle of the far field. The irradiance at any
// distance z is then exactly Gaussian with w(z)² = w0² + (z tan Θ)². At the diffraction limit
// tan Θ = λ/(π w0).
// Source: R. Simon, N. Mukunda, E. C. G. Sudarshan, Phys. Rev. A 29 (1984) 3273; A. E. Siegman,
// Lasers (1986), section 17.1, for w(z) and the diffraction limit.
#include <cmath>

#include "core/constants.h"
#include "core/numerics/vector_math.h"
#include "core/text/format.h"
#include "sources/lamps/settings.h"
#include "sources/profiles/sampling.h"

namespace photorque::kinds::laser {
namespace {

// The paraxial approximation is not valid beyond 30 deg.
constexpr Range paraxial{0.0, 30.0 * degree_rad, false, false};

namespace key {
constexpr NumberKey waist_radius("waist_radius_m", Range::positive(),
                                 "1/e² radius of the irradiance");
constexpr NumberKey divergence_half_angle("divergence_half_angle_deg", paraxial,
                                          "1/e² half angle of the far field",
                                          {.usually = "diffraction"});
}  // namespace key

class GaussianBeam : public Emitter {
 public:
  GaussianBeam(double power_W, double waist_radius_m, double divergence_slope)
      : power_W_(power_W), waist_radius_m_(waist_radius_m), slope_(divergence_slope) {}

  double power_W() const override { return power_W_; }

  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    const auto& bits = samples.bits;
    for (int i = 0; i < ray_block; ++i) {
      const double r_m = waist_radius_m_ * gaussian_radius(bits[0][i]);
      const CirclePoint at = circle_point(bits[1][i]);
      rays.origin_m[0][i] = r_m * at.cos;
      rays.origin_m[1][i] = r_m * at.sin;
      rays.origin_m[2][i] = 0.0;
    }
    for (int i = 0; i < ray_block; ++i) {
      const double slope = slope_ * gaussian_radius(bits[2][i]);
      const CirclePoint towards = circle_point(bits[3][i]);
      const double cosine = 1.0 / std::sqrt(1.0 + slope * slope);
      rays.direction[0][i] = slope * cosine * towards.cos;
      rays.direction[1][i] = slope * cosine * towards.sin;
      rays.direction[2][i] = cosine;
    }
  }

  double relative_intensity(double angle_rad) const override {
    if (angle_rad <= 0.0) return 1.0;
    if (slope_ <= 0.0 || angle_rad >= 0.5 * pi) return 0.0;
    const double x = std::tan(angle_rad) / slope_;
    return std::exp(-2.0 * x * x) / std::pow(std::cos(angle_rad), 3);  // d(slope area) = dΩ/cos³θ
  }

 private:
  // Distance from the axis in units of the 1/e² radius, from a uniform fraction.
  static double gaussian_radius(uint32_t bits) {
    return std::sqrt(-0.5 * log_positive(remainder_of(bits)));
  }

  double power_W_;
  double waist_radius_m_;
  double slope_;
};

std::vector<Beam> make(const Settings& settings, const SourceContext& context) {
  const std::string name = settings.get(source_key::name.with_default("laser"));
  const Vec3 position_m = settings.get(source_key::position);
  const Vec3 direction = read_direction(settings, position_m);
  const Spectrum spectrum = read_line_spectrum(settings, 0.0);
  const double waist_radius_m = settings.get(key::waist_radius);
  const double power_W = settings.get(source_key::power);

  const double limit_rad = std::atan(spectrum.centre_m / (pi * waist_radius_m));
  const double half_angle_rad = settings.get_or(key::divergence_half_angle, limit_rad);
  if (half_angle_rad > paraxial.high) {
    throw settings.error(key::waist_radius, "a waist that diffraction spreads by over 30 deg",
                         "a wider waist");
  }
  if (half_angle_rad < limit_rad * (1.0 - 1e-6) && context.notice) {
    context.notice(
        name +
        printed(": diffraction spreads a waist of %.4g mm by %.4g deg (half-angle, 1/e²), more "
                "than the %.4g deg asked for",
                1e3 * waist_radius_m, limit_rad / degree_rad, half_angle_rad / degree_rad));
  }
  return {{name, std::make_shared<GaussianBeam>(power_W, waist_radius_m, std::tan(half_angle_rad)),
           frame_looking_along(direction, position_m), spectrum}};
}

}  // namespace

SourceKind kind() {
  return {"laser", "A laser beam, Gaussian in position and angle", make,
          joined({{source_key::name.with_default("laser"), source_key::power,
                   source_key::position.meaning("position of the waist, lab axes")},
                  {source_key::direction, source_key::aim},
                  {source_key::wavelength, source_key::spectral_fwhm.with_default(0.0)},
                  {key::waist_radius, key::divergence_half_angle}})};
}

}  // namespace photorque::kinds::laser
