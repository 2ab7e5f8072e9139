#include "scenes/surfaces/settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "core/constants.h"
#include "raytrace/surfaces/bsdf.h"
#include "raytrace/surfaces/glass.h"
#include "raytrace/surfaces/measured_brdf.h"
#include "raytrace/surfaces/mirrors.h"
#include "scenes/surfaces/brdf_file.h"

namespace photorque {
namespace {

constexpr double sum_tolerance = 1e-9;

// One of the fractions: its key, and where it goes.
struct Fraction {
  const char* key;
  BandValues OpticalSurface::*values;
};
constexpr std::array<Fraction, 4> fractions = {{{"absorptance", &OpticalSurface::absorbed},
                                                {"specular", &OpticalSurface::specular},
                                                {"diffuse", &OpticalSurface::diffuse},
                                                {"transmittance", &OpticalSurface::transmitted}}};

// One number for all bands, or an array with one per band.
BandValues read_band_values(const Settings& table, const char* key, int bands, Range range) {
  BandValues values{};
  if (!table.raw(key).is_array()) {
    std::fill_n(values.begin(), bands, table.number(key, range));
    return values;
  }
  const std::vector<double> numbers = table.numbers(key, range);
  if (numbers.size() != static_cast<size_t>(bands)) {
    throw table.error(key, "an array of " + std::to_string(numbers.size()),
                      "one number, or one for each of " + std::to_string(bands) + " band(s)");
  }
  std::copy(numbers.begin(), numbers.end(), values.begin());
  return values;
}

BandValues read_fraction(const Settings& table, const char* key, int bands) {
  return read_band_values(table, key, bands, Range::fraction());
}

// The fraction that goes back where it came from, and the surface for it, if the user has one.
BandValues read_retroreflected(const Settings& table, int bands) {
  constexpr const char* key = "retroreflectance";
  return table.has(key) ? read_fraction(table, key, bands) : BandValues{};
}

// glTF's roughness as the facets' alpha. Below a thousandth it is a mirror.
double read_alpha(const Settings& table) {
  const double roughness = table.number("roughness", {0.0, 1.0, true});
  return std::max(roughness * roughness, 1e-3);
}

bool any(const BandValues& values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return value > 0.0; });
}

std::string sum_text(double sum, size_t band) {
  std::ostringstream text;
  text.precision(12);
  text << "fractions that sum to " << sum << " in band " << band;
  return text.str();
}

std::string list(const std::vector<const Fraction*>& some) {
  std::string text;
  for (const Fraction* fraction : some)
    text += (text.empty() ? "" : ", ") + std::string(fraction->key);
  return text;
}

// "roughness 0.3", for notices.
std::string words(const char* what, double number) {
  std::ostringstream text;
  text.precision(3);
  text << what << " " << number;
  return text.str();
}

// Glass in front of `base`, whose fractions are read.
OpticalSurface read_glass(const Settings& table, const OpticalSurface& base) {
  const double index = table.number("refractive_index", {1.0, 10.0});
  const int kinds = int{any(base.diffuse)} + int{any(base.specular)} + int{any(base.transmitted)};
  if (kinds > 1) {
    throw table.error("refractive_index", "more than one of specular, diffuse, transmittance",
                      "at most one of them behind glass");
  }
  for (const char* key : {"slope_error_mrad", "retroreflectance"}) {
    if (table.has(key)) throw table.error(key, "glass in front too", "no refractive_index beside");
  }
  if (!table.has("roughness")) return behind_glass(base, index);
  if (glass_base(base) != GlassBase::matt) {
    throw table.error("roughness", "specular or transmittance behind glass",
                      "rough glass over diffuse and absorptance alone");
  }
  return behind_glass(base, index, read_alpha(table));
}

// The lobe of the specular fraction, if it is none of a mirror.
void read_lobe(const Settings& table, const OpticalSurface& surface, Bsdf& bsdf) {
  for (const char* key : {"roughness", "slope_error_mrad"}) {
    if (table.has(key) && !any(surface.specular)) {
      throw table.error(key, "no specular fraction", "specular above 0, or refractive_index");
    }
  }
  if (table.has("roughness")) {
    if (table.has("slope_error_mrad")) {
      throw table.error("slope_error_mrad", "roughness too", "one of the two");
    }
    const double alpha = read_alpha(table);
    bsdf.specular = rough_mirror(alpha);
    bsdf.description = words("roughness", std::sqrt(alpha));
  } else if (table.has("slope_error_mrad")) {
    const double slope_rad = table.number("slope_error_mrad", {1e-6, 0.2});
    bsdf.specular = slope_error(slope_rad);
    bsdf.description = words("slope error in mrad", 1e3 * slope_rad);
  }
}

// Heat radiation of a sheet, on both of its surfaces.
void read_heat(const Settings& table, SheetOptics& sheet) {
  const double reemitted = table.number_or("reemitted", 0.0, Range::fraction());
  const double front = table.number_or("emissivity_front", 1.0, Range::fraction());
  const double back = table.number_or("emissivity_back", 1.0, Range::fraction());
  if (reemitted == 0.0) return;
  if (!(front + back > 0.0)) {
    throw table.error("emissivity_front", "0 on both sides", "a side that heat can leave from");
  }
  const auto heat = [&](OpticalSurface& surface) {
    Bsdf bsdf = surface.bsdf ? *surface.bsdf : Bsdf{};
    bsdf.reemitted = reemitted;
    bsdf.front_emission = front / (front + back);
    bsdf.description += (bsdf.description.empty() ? "" : ", ") + words("reemitted", reemitted);
    surface.bsdf = std::make_shared<const Bsdf>(std::move(bsdf));
  };
  heat(sheet.front);
  if (sheet.back) heat(*sheet.back);
}

// Scattering from a table instead of fractions.
OpticalSurface read_measured(const Settings& table, int bands, const std::string& name,
                             const SurfaceFiles& files, std::vector<std::string>& notices) {
  for (const char* key : {"absorptance", "specular", "diffuse", "transmittance", "retroreflectance",
                          "roughness", "slope_error_mrad", "refractive_index"}) {
    if (table.has(key)) throw table.error(key, "brdf_file too", "the table alone");
  }
  const std::string file = table.text("brdf_file");
  const std::optional<std::string> text = files ? files(file) : std::nullopt;
  if (!text) throw table.error("brdf_file", "\"" + file + "\"", "a file that exists");
  BandValues scale{};
  std::fill_n(scale.begin(), bands, 1.0);
  if (table.has("brdf_scale")) {
    scale = read_band_values(table, "brdf_scale", bands, Range::positive());
  }
  const BrdfTable scattering = read_brdf(*text, file);
  if (const auto notice = coverage_notice(scattering)) notices.push_back(file + ": " + *notice);
  MeasuredSurface measured = measured_surface(name, scattering, scale);
  std::ostringstream words;
  words.precision(4);
  if (measured.largest_reflectance > 1.0 + sum_tolerance) {
    words << "a reflectance of " << measured.largest_reflectance << " at "
          << measured.at_incidence_rad / degree_rad << " deg";
    throw table.error("brdf_file", words.str(), "at most 1 at every angle, or a brdf_scale");
  }
  constexpr double worth_telling = 0.01;
  if (measured.asymmetry > worth_telling) {
    words << file << ": f(i, o) and f(o, i) differ by " << 100.0 * measured.asymmetry
          << " % (root mean square), which nature forbids; the mean is taken";
    notices.push_back(words.str());
  }
  return std::move(measured.surface);
}

}  // namespace

OpticalSurface read_surface(const Settings& table, int bands, std::string name) {
  OpticalSurface surface;
  surface.name = std::move(name);
  Bsdf bsdf;
  std::vector<const Fraction*> missing;
  for (const Fraction& fraction : fractions) {
    if (table.has(fraction.key)) {
      surface.*fraction.values = read_fraction(table, fraction.key, bands);
    } else {
      missing.push_back(&fraction);
    }
  }
  const BandValues retroreflected = read_retroreflected(table, bands);
  if (missing.size() == fractions.size() && !any(retroreflected)) {
    throw table.error("", "no optical property", list(missing));
  }
  for (size_t band = 0; band < static_cast<size_t>(bands); ++band) {
    double sum = retroreflected[band];
    for (const Fraction& fraction : fractions) sum += (surface.*fraction.values)[band];
    const bool is_one = std::abs(sum - 1.0) <= sum_tolerance;
    if (missing.size() == 1 && sum < 1.0) {
      (surface.*missing[0]->values)[band] = 1.0 - sum;
      sum = 1.0;
    } else if (!is_one) {
      throw table.error("", sum_text(sum, band),
                        missing.empty() || sum > 1.0
                            ? "a sum of 1"
                            : "a sum of 1, or all but one of " + list(missing) + " too");
    }
    for (const Fraction& fraction : fractions) (surface.*fraction.values)[band] /= sum;
    bsdf.retroreflected[band] = retroreflected[band] / sum;
  }
  if (table.has("refractive_index")) return read_glass(table, surface);
  read_lobe(table, surface, bsdf);
  if (any(bsdf.retroreflected)) {
    bsdf.description +=
        (bsdf.description.empty() ? "" : ", ") + words("retroreflectance", bsdf.retroreflected[0]);
  }
  if (!bsdf.description.empty()) {
    surface.bsdf = std::make_shared<const Bsdf>(std::move(bsdf));
  }
  return surface;
}

SheetOptics read_sheet(const Settings& table, int bands, const std::string& name,
                       const SurfaceFiles& files) {
  SheetOptics sheet;
  const auto side = [&](const Settings& settings, const std::string& called) {
    return settings.has("brdf_file") ? read_measured(settings, bands, called, files, sheet.notices)
                                     : read_surface(settings, bands, called);
  };
  sheet.front = side(table, name);
  if (table.has("back")) sheet.back = side(table.table("back"), name + " (back)");
  read_heat(table, sheet);
  return sheet;
}

}  // namespace photorque
