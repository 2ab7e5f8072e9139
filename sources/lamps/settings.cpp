#include "sources/lamps/settings.h"

#include <cmath>
#include <optional>
#include <utility>

#include "core/files.h"
#include "core/provenance.h"
#include "core/settings/files.h"
#include "core/text/format.h"
#include "sources/profiles/sampling.h"

namespace photorque {
namespace {

namespace lamp_key {
constexpr NumberKey fwhm("fwhm_deg", beam_width, "full width at half of the maximum intensity");
constexpr NumberKey order("order", {2.0, 100.0, false, false},
                          "order of the exponent; 2: a Gaussian, 100: nearly a disc");
constexpr NumberKey half_angle("half_angle_deg", beam_half_angle,
                               "angle from the axis to the edge of the beam");
constexpr ChoiceKey pillbox_measure("pillbox_measure", {"angle", "solid_angle", "projected"},
                                    "measure in which the flux is uniform");
constexpr NumberKey exponent("exponent", {0.0, 1e9, false, false}, "exponent m; 1: Lambert's law");
constexpr ChoiceKey profile(
    "profile",
    {{"gaussian", "exp(−4 ln 2 θ²/fwhm²)"},
     {"super_gaussian", "exp(−ln 2 (2θ/fwhm)^order)"},
     {"pillbox", "constant up to the edge"},
     {"cosine_power", "cosᵐ θ"}},
    "how the radiant intensity, per solid angle, falls with the angle θ from the axis");
constexpr NumberKey halo_fraction(
    "halo_fraction", {0.0, 1.0, false, true},
    "fraction of the flux in an additional, wider Gaussian (`halo_fwhm_deg`)",
    {.usually = "no halo"});
constexpr NumberKey halo_fwhm("halo_fwhm_deg", beam_width, "full width at half maximum of the halo",
                              {.optional = true});
constexpr NumberKey die_size(
    "die_size_m", Range::positive(),
    "edge of a square LED die; used for a warning if no optics can form the beam",
    {.optional = true});
constexpr NumberKey die_diameter("die_diameter_m", Range::positive(),
                                 "diameter of a round LED die, for the same warning",
                                 {.optional = true});
constexpr NumberKey lens_index("lens_index", 1.0, {1.0, 5.0, false, false},
                               "refractive index of the lens around the die");
}  // namespace lamp_key

namespace place_key {
constexpr Vec3sKey positions("positions_m",
                             "positions of several equal lamps, lab axes, instead of `position_m`",
                             {.optional = true});
constexpr NumberKey turn("turn_deg", 0.0, {},
                         "rotation about the beam, right-handed about its direction. At 0, C0 is "
                         "along lab x for a beam straight down; for other beams the lamp is "
                         "rotated by the shortest rotation from there");
}  // namespace place_key

namespace sunlight_key {
constexpr ChoiceKey spectrum("spectrum",
                             {{"blackbody", "Planck's law"},
                              {"AM0", "above the atmosphere, ASTM G173-03, 280 to 4000 nm"},
                              {"AM1.5G", "on the ground, ASTM G173-03, 280 to 4000 nm"}},
                             0, "spectrum of the light");
constexpr NumberKey temperature("temperature_K", solar_temperature_K, {100.0, 1e6, false, false},
                                "temperature of the black body");
constexpr NumberKey irradiance("irradiance_W_m2", solar_irradiance_W_m2, Range::positive(),
                               "irradiance on a plane normal to the light",
                               {.usually = "1361; with `AM1.5G` 1000"});
}  // namespace sunlight_key

AngularProfile read_core(const Settings& settings) {
  using namespace lamp_key;
  enum Shape : size_t { gaussian, super_gaussian, pillbox, cosine_power };
  switch (settings.get(profile)) {
    case super_gaussian:
      return super_gaussian_profile(settings.get(fwhm), settings.get(order));
    case pillbox: {
      constexpr PillboxMeasure measures[] = {PillboxMeasure::angle, PillboxMeasure::solid_angle,
                                             PillboxMeasure::projected};
      const double half_angle_rad = settings.get(half_angle);
      return pillbox_profile(half_angle_rad, measures[settings.get(pillbox_measure)]);
    }
    case cosine_power:
      return cosine_power_profile(settings.get(exponent));
    default:
      return gaussian_profile(settings.get(fwhm));
  }
}

std::optional<Die> read_die(const Settings& settings) {
  using namespace lamp_key;
  const bool square = settings.has(die_size);
  const bool round = settings.has(die_diameter);
  if (square && round) {
    throw settings.error(die_diameter, "also die_size_m", "only one of the two");
  }
  if (!square && !round) return std::nullopt;
  const double size_m = settings.get(square ? die_size : die_diameter);
  return Die{(square ? 1.0 : 0.25 * pi) * size_m * size_m, settings.get(lens_index)};
}

std::string describe(const Vec3& v) {
  return printed("[%g, %g, %g]", v.x(), v.y(), v.z());
}

}  // namespace

Vec3 read_direction_vector(const Settings& settings) {
  const Vec3 direction = settings.get(source_key::direction);
  if (!(direction.stableNorm() > 0.0)) {
    throw settings.error(source_key::direction, describe(direction), "a vector that is not zero");
  }
  return direction.stableNormalized();
}

Vec3 direction_to(const Settings& settings, std::string_view key, const Vec3& from_m,
                  const Vec3& to_m) {
  const Vec3 direction = to_m - from_m;
  if (!(direction.stableNorm() > 0.0)) {
    throw settings.error(key, describe(to_m) + " m, the position of the source itself",
                         "another point");
  }
  return direction.stableNormalized();
}

Vec3 read_direction(const Settings& settings, const Vec3& position_m) {
  const bool aimed = settings.has(source_key::aim);
  const bool directed = settings.has(source_key::direction);
  if (aimed && directed)
    throw settings.error(source_key::direction, "also aim_m", "only one of the two");
  if (!aimed && !directed) {
    throw settings.error(source_key::direction, "neither direction nor aim_m",
                         "a direction or a point to aim at");
  }
  if (directed) return read_direction_vector(settings);
  return direction_to(settings, source_key::aim, position_m, settings.get(source_key::aim));
}

AngularDistribution read_angular_distribution(const Settings& settings) {
  AngularProfile core = read_core(settings);
  if (!settings.has(lamp_key::halo_fraction) && !settings.has(lamp_key::halo_fwhm)) {
    return AngularDistribution(std::move(core));
  }
  const double fraction = settings.get(lamp_key::halo_fraction);
  return AngularDistribution(std::move(core),
                             Halo{gaussian_profile(settings.get(lamp_key::halo_fwhm)), fraction});
}

Spectrum read_line_spectrum(const Settings& settings, double default_fwhm_m) {
  Spectrum spectrum;
  spectrum.shape = Spectrum::Shape::gaussian;
  spectrum.centre_m = settings.get(source_key::wavelength);
  spectrum.fwhm_m = settings.get(source_key::spectral_fwhm.with_default(default_fwhm_m));
  return spectrum;
}

Sunlight read_sunlight(const Settings& settings) {
  constexpr double ground_irradiance_W_m2 = 1000.0;  // IEC 60904-3
  enum : size_t { blackbody, am0, am15g };
  const size_t choice = settings.get(sunlight_key::spectrum);
  Spectrum spectrum;
  spectrum.shape = choice == am0     ? Spectrum::Shape::am0
                   : choice == am15g ? Spectrum::Shape::am15g
                                     : Spectrum::Shape::blackbody;
  if (choice == blackbody) {
    spectrum.temperature_K = settings.get(sunlight_key::temperature);
  }
  return {spectrum, settings.get(sunlight_key::irradiance.with_default(
                        choice == am15g ? ground_irradiance_W_m2 : solar_irradiance_W_m2))};
}

DiscLamp::DiscLamp(double power_W, double aperture_diameter_m, AngularDistribution directions)
    : power_W_(power_W),
      aperture_radius_m_(0.5 * aperture_diameter_m),
      directions_(std::move(directions)) {}

void DiscLamp::emit(const SampleBlock& samples, RayBlock& rays) const {
  ValueBlock rise;
  fill_disc(aperture_radius_m_, samples.bits[0], samples.bits[1], rays.origin_m);
  directions_.rises(samples.bits[2], rise);
  fill_directions(rise, samples.bits[3], rays.direction);
}

double DiscLamp::relative_intensity(double angle_rad) const {
  return directions_.relative_intensity(angle_rad);
}

std::optional<std::string> etendue_notice(const std::string& name, const Die& die,
                                          double aperture_diameter_m,
                                          double effective_solid_angle_sr) {
  const double die_etendue = pi * die.index * die.index * die.area_m2;
  const double aperture_m2 = 0.25 * pi * aperture_diameter_m * aperture_diameter_m;
  const double fraction = aperture_m2 * effective_solid_angle_sr / die_etendue;
  if (fraction >= 1.0) return std::nullopt;
  return name + printed(
                    ": no optics can put more than %.3g %% of this die's light into such a beam; "
                    "the aperture is %.4g mm, all of it needs at least %.4g mm",
                    100.0 * fraction, 1e3 * aperture_diameter_m,
                    1e3 * aperture_diameter_m / std::sqrt(fraction));
}

Lamp read_lamp(const Settings& settings, const SourceContext& context, const std::string& name,
               double power_W) {
  const double diameter_m = settings.get(source_key::aperture_diameter);
  AngularDistribution directions = read_angular_distribution(settings);
  if (const auto die = read_die(settings)) {
    const auto notice =
        etendue_notice(name, *die, diameter_m, directions.effective_solid_angle_sr());
    if (notice && context.notice) context.notice(*notice);
  }
  const double radius_m = 0.5 * diameter_m;
  UniformAperture aperture{radius_m, power_W / (pi * radius_m * radius_m), directions.edges_rad()};
  return {std::make_shared<DiscLamp>(power_W, diameter_m, std::move(directions)),
          read_line_spectrum(settings, usual_led_width_m), std::move(aperture)};
}

SourceFile read_source_file(const Settings& settings, const SourceContext& context) {
  const std::filesystem::path given = settings.text("file");
  if (context.within) {
    if (const auto bytes = context.within(given.string())) {
      if (context.input) context.input(given.string(), content_hash(*bytes));
      return {given.string(), *bytes};
    }
  }
  const std::filesystem::path path = existing_file(settings, "file", context.folder);
  SourceFile file{path.string(), read_file(path)};
  if (context.input) context.input(given.filename().string(), content_hash(file.bytes));
  return file;
}

RigidTransform lamp_frame(const Vec3& direction, const Vec3& origin_m) {
  const Vec3 z = direction.normalized();
  if (z.z() > 1.0 - 1e-12) return {rotation_between(Vec3::UnitZ(), z), origin_m};
  const Quat half_turn(0.0, 1.0, 0.0, 0.0);
  return {(rotation_between(-Vec3::UnitZ(), z) * half_turn).normalized(), origin_m};
}

std::vector<Beam> place_lamps(const Settings& settings, const std::string& name,
                              const std::shared_ptr<const Emitter>& lamp, const Spectrum& spectrum,
                              const std::optional<UniformAperture>& aperture) {
  const bool several = settings.has(place_key::positions);
  if (several && settings.has(source_key::position)) {
    throw settings.error(place_key::positions, "also position_m", "only one of the two");
  }
  const std::vector<Vec3> positions_m = several
                                            ? settings.get(place_key::positions)
                                            : std::vector<Vec3>{settings.get(source_key::position)};
  const double turn_rad = settings.get(place_key::turn);
  const RigidTransform turn{Quat(Eigen::AngleAxisd(turn_rad, Vec3::UnitZ())), Vec3::Zero()};
  std::vector<Beam> beams;
  for (size_t i = 0; i < positions_m.size(); ++i) {
    const Vec3 direction = read_direction(settings, positions_m[i]);
    beams.push_back({several ? name + "[" + std::to_string(i) + "]" : name, lamp,
                     lamp_frame(direction, positions_m[i]) * turn, spectrum, aperture});
  }
  return beams;
}

std::vector<Key> sunlight_keys() {
  using namespace sunlight_key;
  return {spectrum.bringing({{temperature}}), irradiance};
}

std::vector<Key> lamp_keys() {
  using namespace lamp_key;
  using namespace source_key;
  return {aperture_diameter,
          profile.bringing({{fwhm}, {fwhm, order}, {half_angle, pillbox_measure}, {exponent}}),
          halo_fraction,
          halo_fwhm,
          wavelength,
          spectral_fwhm,
          die_size,
          die_diameter,
          lens_index};
}

std::vector<Key> lamp_place_keys() {
  using namespace source_key;
  return {position.optional().meaning("position of the lamp, lab axes; or `positions_m`"),
          place_key::positions, direction, aim, place_key::turn};
}

}  // namespace photorque
