// A lamp as a file of rays: IES TM-25, Zemax binary or LightTools text. The file's z axis points
// along the direction of the lamp.
//
// The fluxes of the rays are scaled to the power. Their sum often differs in scale from the flux
// stated in the file; the difference is reported.
#include "sources/lamps/ray_file.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/numerics/vector_math.h"
#include "core/text/format.h"
#include "sources/lamps/settings.h"

namespace photorque {
namespace {

// Interleaves the bits of four 16-bit numbers, highest first.
uint64_t interleaved(const std::array<uint32_t, 4>& numbers) {
  uint64_t code = 0;
  for (int bit = 15; bit >= 0; --bit) {
    for (const uint32_t number : numbers) code = code << 1 | (number >> bit & 1u);
  }
  return code;
}

// Coordinates for sorting a ray: direction across the beam, and the point where it crosses the
// plane z = 0 (its origin if it is nearly parallel to the plane).
std::array<double, 4> coordinates(const RaySet::Ray& ray) {
  const double along =
      std::abs(ray.direction.z()) > 0.1 ? ray.origin_m.z() / ray.direction.z() : 0.0;
  return {ray.direction.x(), ray.direction.y(), ray.origin_m.x() - along * ray.direction.x(),
          ray.origin_m.y() - along * ray.direction.y()};
}

std::vector<uint32_t> spatial_order(const std::vector<RaySet::Ray>& rays) {
  std::array<double, 4> low, high;
  low.fill(INFINITY);
  high.fill(-INFINITY);
  for (const RaySet::Ray& ray : rays) {
    const auto at = coordinates(ray);
    for (size_t k = 0; k < 4; ++k) {
      low[k] = std::min(low[k], at[k]);
      high[k] = std::max(high[k], at[k]);
    }
  }
  std::vector<std::pair<uint64_t, uint32_t>> keys;
  keys.reserve(rays.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    const auto at = coordinates(rays[i]);
    std::array<uint32_t, 4> cell{};
    for (size_t k = 0; k < 4; ++k) {
      const double width = high[k] - low[k];
      if (width > 0.0) cell[k] = static_cast<uint32_t>(65535.0 * ((at[k] - low[k]) / width));
    }
    keys.emplace_back(interleaved(cell), static_cast<uint32_t>(i));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<uint32_t> order;
  order.reserve(keys.size());
  for (const auto& [key, index] : keys) order.push_back(index);
  return order;
}

}  // namespace

RayLamp::RayLamp(double power_W, const RaySet& set) : power_W_(power_W) {
  const double total = set.ray_flux();
  double before = 0.0;
  for (const uint32_t index : spatial_order(set.rays)) {
    const RaySet::Ray& ray = set.rays[index];
    if (!(ray.flux > 0.0)) continue;
    const Vec3 d = ray.direction.normalized();
    entries_.push_back({before / total,
                        {ray.origin_m.x(), ray.origin_m.y(), ray.origin_m.z()},
                        {d.x(), d.y(), d.z()}});
    before += ray.flux;
  }
  index_.build(entries_, entries_.size());
  tabulate_intensity(set);
}

void RayLamp::tabulate_intensity(const RaySet& set) {
  std::vector<std::pair<double, double>> rises;  // and fluxes
  for (const RaySet::Ray& ray : set.rays) {
    const Vec3 d = ray.direction.normalized();
    const double sine2 = d.head<2>().squaredNorm();
    // This form of 1 − cos θ does not cancel near the axis.
    rises.emplace_back(d.z() > 0.0 ? sine2 / (1.0 + d.z()) : 1.0 - d.z(), ray.flux);
  }
  std::sort(rises.begin(), rises.end());
  // Steps of 1 % of the rays, with fewer rays per step in the tail.
  constexpr size_t steps = 100, fewest_rays = 4;
  constexpr double narrowest = 1e-30;  // rises of directions 1e-15 rad apart count as equal
  double inner = 0.0, flux = 0.0, largest = 0.0;
  size_t first = 0;
  for (size_t i = 0; i < rises.size(); ++i) {
    flux += rises[i].second;
    const bool is_last = i + 1 == rises.size();
    const size_t left = rises.size() - first;
    const size_t wanted = std::max(fewest_rays, std::min(rises.size() / steps, left / 8));
    if (!is_last && i + 1 - first < wanted) continue;
    const double outer = is_last ? rises[i].first : 0.5 * (rises[i].first + rises[i + 1].first);
    if (outer - inner > narrowest) {
      edge_rise_.push_back(outer);
      step_.push_back(flux / (outer - inner));
    } else if (is_last && !step_.empty()) {
      const double before = step_.size() > 1 ? edge_rise_[step_.size() - 2] : 0.0;
      step_.back() += flux / (inner - before);
    } else {
      continue;  // rays of equal direction: add them to the next step
    }
    largest = std::max(largest, step_.back());
    inner = outer;
    flux = 0.0;
    first = i + 1;
  }
  for (double& value : step_) value /= largest;
}

void RayLamp::emit(const SampleBlock& samples, RayBlock& rays) const {
  for (int i = 0; i < ray_block; ++i) {
    const Entry& entry = index_.find(entries_, fraction_of(samples.bits[2][i]));
    for (size_t axis = 0; axis < 3; ++axis) {
      rays.origin_m[axis][i] = entry.origin_m[axis];
      rays.direction[axis][i] = entry.direction[axis];
    }
  }
}

double RayLamp::relative_intensity(double angle_rad) const {
  if (edge_rise_.empty()) return angle_rad == 0.0 ? 1.0 : 0.0;
  const auto edge = std::lower_bound(edge_rise_.begin(), edge_rise_.end(), rise_at(angle_rad));
  if (edge == edge_rise_.end()) return 0.0;
  return step_[static_cast<size_t>(edge - edge_rise_.begin())];
}

}  // namespace photorque

namespace photorque::kinds::ray_file {
namespace {

namespace key {
constexpr TextKey file("file", "IES TM-25, Zemax binary or LightTools text");
}  // namespace key

std::string sum_notice(const RaySet& set) {
  const bool watts = set.flux_unit == RaySet::FluxUnit::watt;
  const std::optional<double>& stated =
      watts ? set.stated_radiant_flux_W : set.stated_luminous_flux_lm;
  const double sum = set.ray_flux();
  constexpr double rounding = 1e-4;
  if (!stated || std::abs(sum - *stated) <= rounding * *stated) return "";
  return printed(
      "the fluxes of its rays sum to %.6g %s, the file states %.6g %s; "
      "they are scaled by %.6g",
      sum, watts ? "W" : "lm", *stated, watts ? "W" : "lm", *stated / sum);
}

double read_power(const Settings& settings, const RaySet& set) {
  if (settings.has(source_key::power)) return settings.get(source_key::power);
  if (set.stated_radiant_flux_W) return *set.stated_radiant_flux_W;
  throw settings.error(source_key::power, "nothing, in a file without radiant flux",
                       "a power in watts");
}

Spectrum read_spectrum(const Settings& settings, const RaySet& set, std::string& notice) {
  if (settings.has(source_key::wavelength)) return read_line_spectrum(settings, usual_led_width_m);
  double flux = 0.0, moment = 0.0;
  for (const RaySet::Ray& ray : set.rays) {
    if (!(ray.wavelength_m > 0.0)) continue;
    flux += ray.flux;
    moment += ray.flux * ray.wavelength_m;
  }
  if (flux > 0.0) notice = "wavelengths of single rays are replaced by their mean";
  if (!(flux > 0.0) && !set.wavelength_m) {
    throw settings.error(source_key::wavelength, "nothing, in a file without wavelength",
                         "a wavelength");
  }
  Spectrum spectrum;
  spectrum.centre_m = flux > 0.0 ? moment / flux : *set.wavelength_m;
  spectrum.fwhm_m = settings.get(source_key::spectral_fwhm);
  return spectrum;
}

std::vector<Beam> make(const Settings& settings, const SourceContext& context) {
  const std::string name = settings.get(source_key::name.with_default("ray_file"));
  const SourceFile source = read_source_file(settings, context);
  const RaySet set = read_rays(source.bytes, source.name);
  const double power_W = read_power(settings, set);
  std::string wavelengths;
  const Spectrum spectrum = read_spectrum(settings, set, wavelengths);
  const std::string noise = std::to_string(set.rays.size()) +
                            " rays; the standard errors do not include the noise of the file";
  for (const std::string& line : {sum_notice(set), wavelengths, noise}) {
    if (context.notice && !line.empty()) context.notice(name + ": " + line);
  }
  return place_lamps(settings, name, std::make_shared<RayLamp>(power_W, set), spectrum);
}

}  // namespace

SourceKind kind() {
  return {"ray_file", "A lamp as a file of rays: IES TM-25, Zemax binary or LightTools text", make,
          joined({{source_key::name.with_default("ray_file"), key::file,
                   source_key::power.usually("the file's")},
                  {source_key::wavelength.usually("the file's"), source_key::spectral_fwhm},
                  lamp_place_keys()})};
}

}  // namespace photorque::kinds::ray_file
