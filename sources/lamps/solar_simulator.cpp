// A solar simulator: a beam of limited width and collimation that lights a round field uniformly or
// nearly so.
//
// Nonuniformity is defined as in IEC 60904-9. The irradiance decreases from the centre as E(r) = E0
// (1 − k r²/R²) with k = 2u/(1 + u), which has the nonuniformity u. Every point of the field sees
// the same disc of constant radiance. The field is therefore sharp in its plane; in front of it and
// behind it, it blurs by the half-angle.
#include <cmath>

#include "core/constants.h"
#include "core/numerics/vector_math.h"
#include "sources/lamps/settings.h"
#include "sources/profiles/sampling.h"

namespace photorque::kinds::solar_simulator {
namespace {

namespace key {
constexpr NumberKey footprint_diameter("footprint_diameter_m", Range::positive(),
                                       "diameter of the lit field");
constexpr NumberKey collimation_half_angle("collimation_half_angle_deg", solar_angular_radius_rad,
                                           {0.0, 0.25 * pi},
                                           "half-angle of the cone of light on every point");
constexpr NumberKey nonuniformity("nonuniformity", 0.0, {0.0, 1.0, false, true},
                                  "(max − min)/(max + min) of the irradiance on the field");
}  // namespace key

class SolarSimulator : public Emitter {
 public:
  struct Field {
    double irradiance_W_m2, radius_m, fall;  // fall: k above, ∈ [0, 1)
    double half_angle_rad;
    double distance_m;  // distance of the field's plane from z = 0
  };
  explicit SolarSimulator(const Field& field) : field_(field) {}

  double power_W() const override {
    return field_.irradiance_W_m2 * pi * field_.radius_m * field_.radius_m *
           (1.0 - 0.5 * field_.fall);
  }

  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    const double sine = std::sin(field_.half_angle_rad);
    const double whole = 1.0 - 0.5 * field_.fall;
    ValueBlock rise;
    for (int i = 0; i < ray_block; ++i) {
      const double sine2 = sine * sine * fraction_of(samples.bits[2][i]);
      rise[i] = sine2 / (1.0 + std::sqrt(1.0 - sine2));
    }
    fill_directions(rise, samples.bits[3], rays.direction);
    for (int i = 0; i < ray_block; ++i) {
      // Inverts the fraction of the power within r, (s − k s²/2)/(1 − k/2) with s = r²/R².
      const double fraction = whole * fraction_of(samples.bits[0][i]);
      const double s = 2.0 * fraction / (1.0 + std::sqrt(1.0 - 2.0 * field_.fall * fraction));
      const double r_m = field_.radius_m * std::sqrt(s);
      const CirclePoint turn = circle_point(samples.bits[1][i]);
      const double back = field_.distance_m / rays.direction[2][i];
      rays.origin_m[0][i] = r_m * turn.cos - back * rays.direction[0][i];
      rays.origin_m[1][i] = r_m * turn.sin - back * rays.direction[1][i];
      rays.origin_m[2][i] = 0.0;
    }
  }

  double relative_intensity(double angle_rad) const override {
    return angle_rad <= field_.half_angle_rad ? std::cos(angle_rad) : 0.0;
  }

 private:
  Field field_;
};

std::vector<Beam> make(const Settings& settings, const SourceContext& context) {
  const std::string name = settings.get(source_key::name.with_default("solar_simulator"));
  const Vec3 position_m = settings.get(source_key::position);
  const Vec3 direction = read_direction_vector(settings);
  // The rays start outside the sphere that contains the scene.
  constexpr double margin = 1.001;
  const double distance_m = margin * (context.scene_radius_m + position_m.norm());
  const double nonuniformity = settings.get(key::nonuniformity);
  const Sunlight light = read_sunlight(settings);
  const SolarSimulator::Field field{light.irradiance_W_m2,
                                    0.5 * settings.get(key::footprint_diameter),
                                    2.0 * nonuniformity / (1.0 + nonuniformity),
                                    settings.get(key::collimation_half_angle), distance_m};
  return {{name, std::make_shared<SolarSimulator>(field),
           frame_looking_along(direction, position_m - distance_m * direction), light.spectrum}};
}

}  // namespace

SourceKind kind() {
  return {"solar_simulator", "A bundle of limited width and collimation that lights a round field",
          make,
          joined({{source_key::name.with_default("solar_simulator"),
                   source_key::position.meaning("middle of the field, lab axes"),
                   source_key::light_direction},
                  sunlight_keys(),
                  {key::footprint_diameter, key::collimation_half_angle, key::nonuniformity}})};
}

}  // namespace photorque::kinds::solar_simulator
