// A lamp with measured intensity from an IES LM-63, IES TM-33 or EULUMDAT file, or from a table in
// the experiment. Only the shape of the intensity is used: the experiment states the power. The
// file's nadir (γ = 0) points along the direction of the lamp.
#include "sources/lamps/ies.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/constants.h"
#include "core/files.h"
#include "core/numerics/vector_math.h"
#include "core/text/format.h"
#include "sources/lamps/settings.h"
#include "sources/photometry/file.h"
#include "sources/profiles/beam_shape.h"

namespace photorque {
namespace {

constexpr size_t average_steps = 3600;

void fill_rectangle(double x_m, double y_m, const SampleBlock& samples, VectorBlock& point_m) {
  for (int i = 0; i < ray_block; ++i) {
    point_m[0][i] = x_m * (fraction_of(samples.bits[0][i]) - 0.5);
    point_m[1][i] = y_m * (fraction_of(samples.bits[1][i]) - 0.5);
    point_m[2][i] = 0.0;
  }
}

void fill_ellipse(double x_m, double y_m, const SampleBlock& samples, VectorBlock& point_m) {
  fill_disc(0.5, samples.bits[0], samples.bits[1], point_m);
  for (int i = 0; i < ray_block; ++i) {
    point_m[0][i] *= x_m;
    point_m[1][i] *= y_m;
  }
}

}  // namespace

PhotometricLamp::PhotometricLamp(double power_W, const Opening& opening,
                                 TabulatedIntensity intensity)
    : power_W_(power_W), opening_(opening), intensity_(std::move(intensity)) {
  const IntensityTable& table = intensity_.table();
  if (table.pole == Pole::beam) {
    for (const double polar_rad : table.polar_rad) {
      largest_average_ = std::max(largest_average_, intensity_.mean(polar_rad));
    }
    return;
  }
  for (size_t i = 0; i <= average_steps; ++i) {
    average_.push_back(round_average(pi * static_cast<double>(i) / average_steps));
    largest_average_ = std::max(largest_average_, average_.back());
  }
}

double PhotometricLamp::round_average(double angle_rad) const {
  constexpr int turns = 180;
  double sum = 0.0;
  for (int k = 0; k < turns; ++k) {
    const double turn_rad = 2.0 * pi * (k + 0.5) / turns;
    const double sine = std::sin(angle_rad);
    const GoniometerAngles at =
        table_angles(intensity_.table().pole,
                     {sine * std::cos(turn_rad), sine * std::sin(turn_rad), std::cos(angle_rad)});
    sum += intensity_.at(at.polar_rad, at.azimuth_rad);
  }
  return sum / turns;
}

void PhotometricLamp::emit(const SampleBlock& samples, RayBlock& rays) const {
  if (opening_.shape == Opening::Shape::ellipse) {
    fill_ellipse(opening_.x_m, opening_.y_m, samples, rays.origin_m);
  } else {
    fill_rectangle(opening_.x_m, opening_.y_m, samples, rays.origin_m);
  }
  intensity_.directions(samples.bits[2], samples.bits[3], rays.direction);
}

double PhotometricLamp::relative_intensity(double angle_rad) const {
  if (average_.empty()) return std::min(1.0, intensity_.mean(angle_rad) / largest_average_);
  const double place = std::clamp(angle_rad / pi, 0.0, 1.0) * average_steps;
  const size_t below = std::min(static_cast<size_t>(place), average_steps - 1);
  const double mean =
      std::lerp(average_[below], average_[below + 1], place - static_cast<double>(below));
  return std::min(1.0, mean / largest_average_);
}

std::optional<UniformAperture> uniform_aperture(const PhotometricLamp& lamp) {
  const IntensityTable& table = lamp.intensity().table();
  const Opening& opening = lamp.opening();
  const bool disc = opening.shape == Opening::Shape::ellipse && opening.x_m == opening.y_m;
  if (!disc || table.pole != Pole::beam || table.planes() > 1) return std::nullopt;
  size_t dark = table.polar_rad.size();  // the intensity is zero from this angle on
  while (table.intensity[dark - 1] <= 0.0) --dark;
  const double end_rad = table.polar_rad[std::min(dark, table.polar_rad.size() - 1)];
  if (end_rad > 0.5 * pi * (1.0 + 1e-12) || end_rad <= 0.0) return std::nullopt;
  const double radius_m = 0.5 * opening.x_m;
  UniformAperture aperture{radius_m, lamp.power_W() / (pi * radius_m * radius_m), {}};
  if (table.polar_rad.front() > 0.0) aperture.edges_rad.push_back(table.polar_rad.front());
  // Edges at octaves of the beam's width, so that its core is resolved however far the table
  // extends.
  for (double edge_rad = full_width_rad(lamp, 0.5); edge_rad > 0.0 && edge_rad < 0.9 * end_rad;
       edge_rad *= 2.0) {
    if (edge_rad > table.polar_rad.front()) aperture.edges_rad.push_back(edge_rad);
  }
  aperture.edges_rad.push_back(std::min(end_rad, 0.5 * pi));
  return aperture;
}

std::optional<std::string> coarseness_notice(const PhotometricLamp& lamp) {
  constexpr double allowed = 2e-3;
  const auto [straight, zonal] = lamp.intensity().coarseness();
  if (std::abs(straight) <= allowed) return std::nullopt;
  const std::vector<double>& polar = lamp.intensity().table().polar_rad;
  const double fwhm_rad = full_width_rad(lamp, 0.5);
  // The step that contains half of the maximum, where the intensity is steepest.
  const auto above = std::upper_bound(polar.begin() + 1, polar.end() - 1, 0.5 * fwhm_rad);
  const double step_deg = (*above - *(above - 1)) / degree_rad;
  // Both errors are of second order in the step.
  const double enough_deg = step_deg * std::sqrt(allowed / std::abs(straight));
  return printed(
      "steps of %.3g deg are coarse for a beam of %.4g deg FWHM: compared with the smooth "
      "interpolation used here, linear interpolation changes the flux by %+.2f %%, a sum "
      "of zones by %+.2f %%; steps of %.2g deg suffice",
      step_deg, fwhm_rad / degree_rad, 100.0 * straight, 100.0 * zonal, enough_deg);
}

}  // namespace photorque

namespace photorque::kinds::ies {
namespace {

namespace key {
constexpr TextKey file(
    "file", "IES LM-63, IES TM-33 or EULUMDAT; or a table of `polar_deg` and `intensity`",
    {.optional = true});
constexpr NumbersKey polar("polar_deg", {0.0, pi},
                           "instead of `file`: angles from the axis, in rising order",
                           {.optional = true});
constexpr NumbersKey azimuth("azimuth_deg", {0.0, 2.0 * pi, false, true},
                             "with `polar_deg`, if the beam is not rotationally symmetric: angles "
                             "about the axis, in rising order",
                             {.optional = true});
constexpr NumbersKey intensity("intensity", Range::not_negative(),
                               "radiant intensity at every angle of `polar_deg`, in any scale; "
                               "with `azimuth_deg` one row for each azimuth",
                               {.optional = true});
}  // namespace key

PhotometricFile read_inline(const Settings& settings) {
  StoredPlanes stored;
  const std::vector<double> polar_rad = settings.get(key::polar);
  for (const double angle_rad : polar_rad) stored.polar_deg.push_back(angle_rad / degree_rad);
  require_ascending(stored.polar_deg, settings.name() + ".polar_deg", settings.where());
  stored.azimuth_deg = {0.0};
  if (settings.has(key::azimuth)) {
    stored.azimuth_deg.clear();
    for (const double angle_rad : settings.get(key::azimuth)) {
      stored.azimuth_deg.push_back(angle_rad / degree_rad);
    }
    require_ascending(stored.azimuth_deg, settings.name() + ".azimuth_deg", settings.where());
  }
  stored.intensity = settings.get(key::intensity);
  const size_t expected = stored.polar_deg.size() * stored.azimuth_deg.size();
  if (stored.polar_deg.size() < 2 || stored.intensity.size() != expected) {
    throw settings.error(key::intensity, std::to_string(stored.intensity.size()) + " numbers",
                         "one for every angle of polar_deg (at least two) and azimuth_deg: " +
                             std::to_string(expected));
  }
  PhotometricFile file;
  file.table = unfold(stored, PlaneSymmetry::none, settings.where());
  require_light(file, settings.where());
  return file;
}

PhotometricFile read_table(const Settings& settings, const SourceContext& context) {
  if (!settings.has(key::file)) return read_inline(settings);
  const SourceFile source = read_source_file(settings, context);
  return read_photometric(source.bytes, source.name);
}

std::vector<Beam> make(const Settings& settings, const SourceContext& context) {
  const std::string name = settings.get(source_key::name.with_default("ies"));
  const double power_W = settings.get(source_key::power);
  PhotometricFile file = read_table(settings, context);
  if (settings.has(source_key::aperture_diameter)) {
    const double diameter_m = settings.get(source_key::aperture_diameter);
    file.opening = {Opening::Shape::ellipse, diameter_m, diameter_m};
  }
  const auto lamp = std::make_shared<PhotometricLamp>(power_W, file.opening,
                                                      TabulatedIntensity(std::move(file.table)));
  if (const auto coarse = coarseness_notice(*lamp)) file.notices.push_back(*coarse);
  for (const std::string& line : file.notices) {
    if (context.notice) context.notice(name + ": " + line);
  }
  return place_lamps(settings, name, lamp, read_line_spectrum(settings, usual_led_width_m),
                     uniform_aperture(*lamp));
}

}  // namespace

SourceKind kind() {
  return {"ies",
          "A lamp with a measured intensity: an IES LM-63, IES TM-33 or EULUMDAT file, or a table",
          make,
          joined({{source_key::name.with_default("ies"), key::file, source_key::power},
                  {source_key::wavelength, source_key::spectral_fwhm},
                  lamp_place_keys(),
                  {source_key::aperture_diameter.usually("the file's; of a table a point"),
                   key::polar, key::azimuth, key::intensity}})};
}

}  // namespace photorque::kinds::ies
