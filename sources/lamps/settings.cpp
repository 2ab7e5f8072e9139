#include "sources/lamps/settings.h"

#include <cstdio>
#include <optional>
#include <utility>

#include "core/constants.h"
#include "core/files.h"
#include "core/provenance.h"
#include "sources/lamps/disc.h"
#include "sources/lamps/keys.h"

namespace photorque {
namespace {

AngularProfile read_core(const Settings& settings) {
  enum Shape : size_t { gaussian, super_gaussian, pillbox, cosine_power };
  switch (settings.choice("profile", {"gaussian", "super_gaussian", "pillbox", "cosine_power"})) {
    case super_gaussian:
      return super_gaussian_profile(settings.number("fwhm_deg", beam_width),
                                    settings.number("order", {2.0, 100.0, false, false}));
    case pillbox: {
      constexpr PillboxMeasure measures[] = {PillboxMeasure::angle, PillboxMeasure::solid_angle,
                                             PillboxMeasure::projected};
      const double half_angle_rad = settings.number("half_angle_deg", beam_half_angle);
      return pillbox_profile(
          half_angle_rad,
          measures[settings.choice("pillbox_measure", {"angle", "solid_angle", "projected"})]);
    }
    case cosine_power:
      return cosine_power_profile(settings.number("exponent", {0.0, 1e9, false, false}));
    default:
      return gaussian_profile(settings.number("fwhm_deg", beam_width));
  }
}

std::optional<Die> read_die(const Settings& settings) {
  const bool square = settings.has("die_size_m");
  const bool round = settings.has("die_diameter_m");
  if (square && round) {
    throw settings.error("die_diameter_m", "also die_size_m", "only one of the two");
  }
  if (!square && !round) return std::nullopt;
  const double size_m =
      settings.number(square ? "die_size_m" : "die_diameter_m", Range::positive());
  return Die{(square ? 1.0 : 0.25 * pi) * size_m * size_m,
             settings.number_or("lens_index", 1.0, {1.0, 5.0, false, false})};
}

std::string describe(const Vec3& v) {
  char text[96];
  std::snprintf(text, sizeof text, "[%g, %g, %g]", v.x(), v.y(), v.z());
  return text;
}

}  // namespace

Vec3 read_direction_vector(const Settings& settings) {
  const Vec3 direction = settings.vector3("direction");
  if (!(direction.stableNorm() > 0.0)) {
    throw settings.error("direction", describe(direction), "a vector of some length");
  }
  return direction.stableNormalized();
}

Vec3 direction_to(const Settings& settings, const std::string& key, const Vec3& from_m,
                  const Vec3& to_m) {
  const Vec3 direction = to_m - from_m;
  if (!(direction.stableNorm() > 0.0)) {
    throw settings.error(key, describe(to_m) + " m, the position of the source itself",
                         "another point");
  }
  return direction.stableNormalized();
}

Vec3 read_direction(const Settings& settings, const Vec3& position_m) {
  const bool aimed = settings.has("aim_m");
  const bool directed = settings.has("direction");
  if (aimed && directed) throw settings.error("direction", "also aim_m", "only one of the two");
  if (!aimed && !directed) {
    throw settings.error("direction", "neither direction nor aim_m",
                         "a direction or a point to aim at");
  }
  if (directed) return read_direction_vector(settings);
  return direction_to(settings, "aim_m", position_m, settings.vector3("aim_m"));
}

AngularDistribution read_angular_distribution(const Settings& settings) {
  AngularProfile core = read_core(settings);
  if (!settings.has("halo_fraction") && !settings.has("halo_fwhm_deg")) {
    return AngularDistribution(std::move(core));
  }
  const double fraction = settings.number("halo_fraction", {0.0, 1.0, false, true});
  return AngularDistribution(
      std::move(core),
      Halo{gaussian_profile(settings.number("halo_fwhm_deg", beam_width)), fraction});
}

Spectrum read_line_spectrum(const Settings& settings, double default_fwhm_m) {
  Spectrum spectrum;
  spectrum.shape = Spectrum::Shape::gaussian;
  spectrum.centre_m = settings.number("wavelength_nm", {1e-8, 1e-3});
  spectrum.fwhm_m = settings.number_or("spectral_fwhm_nm", default_fwhm_m, {0.0, 1e-3});
  return spectrum;
}

Sunlight read_sunlight(const Settings& settings) {
  constexpr double ground_irradiance_W_m2 = 1000.0;  // IEC 60904-3
  enum : size_t { blackbody, am0, am15g };
  const size_t choice = settings.choice_or("spectrum", {"blackbody", "AM0", "AM1.5G"}, blackbody);
  Spectrum spectrum;
  spectrum.shape = choice == am0     ? Spectrum::Shape::am0
                   : choice == am15g ? Spectrum::Shape::am15g
                                     : Spectrum::Shape::blackbody;
  if (choice == blackbody) {
    spectrum.temperature_K =
        settings.number_or("temperature_K", solar_temperature_K, {100.0, 1e6, false, false});
  }
  return {spectrum,
          settings.number_or("irradiance_W_m2",
                             choice == am15g ? ground_irradiance_W_m2 : solar_irradiance_W_m2,
                             Range::positive())};
}

Lamp read_lamp(const Settings& settings, const SourceContext& context, const std::string& name,
               double power_W) {
  const double diameter_m = settings.number("aperture_diameter_m", opening_diameter);
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
  const std::filesystem::path path = context.folder / given;
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) {
    throw settings.error("file", "\"" + given.string() + "\"",
                         "a file that exists beside the experiment");
  }
  SourceFile file{path.string(), read_file(path)};
  if (context.input) context.input(given.filename().string(), content_hash(file.bytes));
  return file;
}

std::vector<Beam> place_lamps(const Settings& settings, const std::string& name,
                              const std::shared_ptr<const Emitter>& lamp, const Spectrum& spectrum,
                              const std::optional<UniformAperture>& aperture) {
  const bool several = settings.has("positions_m");
  if (several && settings.has("position_m")) {
    throw settings.error("positions_m", "also position_m", "only one of the two");
  }
  const std::vector<Vec3> positions_m = several ? settings.vectors3("positions_m")
                                                : std::vector<Vec3>{settings.vector3("position_m")};
  const double turn_rad = settings.number_or("turn_deg", 0.0);
  const RigidTransform turn{Quat(Eigen::AngleAxisd(turn_rad, Vec3::UnitZ())), Vec3::Zero()};
  std::vector<Beam> beams;
  for (size_t i = 0; i < positions_m.size(); ++i) {
    const Vec3 direction = read_direction(settings, positions_m[i]);
    beams.push_back({several ? name + "[" + std::to_string(i) + "]" : name, lamp,
                     frame_looking_along(direction, positions_m[i]) * turn, spectrum, aperture});
  }
  return beams;
}

}  // namespace photorque
