#include "scenes/surfaces/settings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.h"
#include "core/text/format.h"
#include "raytrace/surfaces/glass.h"
#include "raytrace/surfaces/mirrors.h"

namespace photorque {
namespace {

constexpr double sum_tolerance = 1e-9;

namespace surface_key {
constexpr NumberKey fraction(std::string_view name, std::string_view what) {
  return NumberKey(name, Range::fraction(), what, {.optional = true, .several = true});
}
constexpr NumberKey absorptance =
    fraction("absorptance", "fraction of the incident power; a number or one per band");
constexpr NumberKey specular = fraction("specular", "fraction that is mirrored");
constexpr NumberKey diffuse = fraction("diffuse", "fraction that is scattered by Lambert's law");
constexpr NumberKey transmittance =
    fraction("transmittance",
             "fraction that passes straight through. The fractions, with `retroreflectance`, sum "
             "to 1; one of the first four may be omitted");
constexpr NumberKey retroreflectance =
    fraction("retroreflectance", "additional fraction that is reflected back to the source");
constexpr NumberKey roughness(
    "roughness", {0.0, 1.0, true},
    "roughness as in glTF: the specular fraction follows GGX microfacets with alpha = roughness² "
    "and Smith masking; light reflected more than once is included, so that `specular` is the "
    "reflectance at every angle",
    {.optional = true});
constexpr NumberKey slope_error(
    "slope_error_mrad", {1e-6, 0.2},
    "instead of `roughness`: a mirror with random slopes of this size (`slope_error_shape`); "
    "reflected rays deviate by twice the slope. Two sizes: [along `slope_error_axis`, across it]",
    {.optional = true, .several = true});
constexpr ChoiceKey slope_error_shape(
    "slope_error_shape",
    {{"gaussian",
      "normal slopes (tangents) along each of two axes; the size is their standard "
      "deviation"},
     {"pillbox", "slopes uniform over a disc; the size is its radius"}},
    0, "distribution of the slopes");
constexpr Vec3Key slope_error_axis("slope_error_axis",
                                   "with two sizes: the first one acts along the projection of "
                                   "this direction onto the surface, body axes; "
                                   "it rotates with a `[[joint]]`",
                                   {.optional = true});
constexpr NumberKey refractive_index(
    "refractive_index", {1.0, 10.0},
    "glass in front, by Fresnel's law for unpolarised light; the fractions are those behind it",
    {.optional = true});
constexpr TextKey brdf_file("brdf_file", "file of measured scattering, instead of the fractions",
                            {.optional = true});
constexpr NumberKey brdf_scale("brdf_scale", 1.0, Range::positive(),
                               "factor on the BRDF; a number or one per band", {.several = true});
constexpr TableKey back("back", "the same for the other side", {.usually = "as the front"});
constexpr NumberKey reemitted(
    "reemitted", 0.0, Range::fraction(),
    "fraction of the absorbed power that both sides emit at once as heat, by Lambert's law, in "
    "proportion to their emissivities. It acts on forces and torques only: the power counts as "
    "absorbed, and heat lights no other part");
constexpr NumberKey emissivity_front("emissivity_front", 1.0, Range::fraction(),
                                     "emissivity of the front side for `reemitted`");
constexpr NumberKey emissivity_back("emissivity_back", 1.0, Range::fraction(),
                                    "emissivity of the back side for `reemitted`");
}  // namespace surface_key

// A fraction: its key and its member of OpticalSurface.
struct Fraction {
  NumberKey key;
  BandValues OpticalSurface::*values;
};
constexpr std::array<Fraction, 4> fractions = {
    {{surface_key::absorptance, &OpticalSurface::absorbed},
     {surface_key::specular, &OpticalSurface::specular},
     {surface_key::diffuse, &OpticalSurface::diffuse},
     {surface_key::transmittance, &OpticalSurface::transmitted}}};

// One number for all bands, or an array with one per band.
BandValues read_band_values(const Settings& table, const NumberKey& key, int bands) {
  BandValues values{};
  if (!table.raw(key).is_array()) {
    std::fill_n(values.begin(), bands, table.get(key));
    return values;
  }
  const std::vector<double> numbers = table.numbers(key, key.range);
  if (numbers.size() != static_cast<size_t>(bands)) {
    throw table.error(key, "an array of " + std::to_string(numbers.size()),
                      "one number, or one for each of " + std::to_string(bands) + " band(s)");
  }
  std::copy(numbers.begin(), numbers.end(), values.begin());
  return values;
}

// Retroreflected fraction per band; zero without the key.
BandValues read_retroreflected(const Settings& table, int bands) {
  const NumberKey& key = surface_key::retroreflectance;
  return table.has(key) ? read_band_values(table, key, bands) : BandValues{};
}

// The facets' alpha from glTF's roughness. Below 0.001 the surface is a mirror.
double read_alpha(const Settings& table) {
  const double roughness = table.get(surface_key::roughness);
  return std::max(roughness * roughness, 1e-3);
}

std::string list(const std::vector<const Fraction*>& some) {
  return joined_text(some, ", ", [](const Fraction* fraction) { return fraction->key.name; });
}

// Glass in front of `base`, whose fractions have been read.
OpticalSurface read_glass(const Settings& table, const OpticalSurface& base) {
  const double index = table.get(surface_key::refractive_index);
  const int kinds = int{any_positive(base.diffuse)} + int{any_positive(base.specular)} +
                    int{any_positive(base.transmitted)};
  if (kinds > 1) {
    throw table.error(surface_key::refractive_index,
                      "more than one of specular, diffuse, transmittance",
                      "at most one of them behind glass");
  }
  for (const NumberKey& key : {surface_key::slope_error, surface_key::retroreflectance}) {
    if (table.has(key)) throw table.error(key, "glass in front too", "no refractive_index beside");
  }
  if (!table.has(surface_key::roughness)) return behind_glass(base, index);
  if (glass_base(base) != GlassBase::matt) {
    throw table.error(surface_key::roughness, "specular or transmittance behind glass",
                      "rough glass over diffuse and absorptance alone");
  }
  return behind_glass(base, index, read_alpha(table));
}

void read_slope_error(const Settings& table, Bsdf& bsdf) {
  using namespace surface_key;
  const NumberKey& key = surface_key::slope_error;
  const SlopeShape shape =
      table.get(slope_error_shape) == 0 ? SlopeShape::gaussian : SlopeShape::pillbox;
  if (!table.raw(key).is_array()) {
    const double slope_rad = table.get(key);
    if (table.has(slope_error_axis)) {
      throw table.error(slope_error_axis, "an axis for one size",
                        "two sizes: slope_error_mrad = [along it, across it]");
    }
    bsdf.specular = photorque::slope_error(slope_rad, shape);
    bsdf.description = printed("slope error in mrad %.3g", 1e3 * slope_rad);
    return;
  }
  const std::vector<double> slopes_rad = table.numbers(key, key.range);
  if (slopes_rad.size() != 2) {
    throw table.error(key, "an array of " + std::to_string(slopes_rad.size()),
                      "one number, or two: along slope_error_axis and across it");
  }
  if (!table.has(slope_error_axis)) {
    throw table.error(key, "two numbers without slope_error_axis", "slope_error_axis beside");
  }
  bsdf.axis = table.get(slope_error_axis);
  if (!(bsdf.axis.stableNorm() > 0.0)) {
    throw table.error(slope_error_axis, "a vector without length", "a direction in body axes");
  }
  bsdf.axis.stableNormalize();
  bsdf.specular = photorque::slope_error(slopes_rad[0], slopes_rad[1], shape);
  bsdf.description =
      printed("slope error in mrad %.3g and %.3g", 1e3 * slopes_rad[0], 1e3 * slopes_rad[1]);
}

// Reads the lobe of the specular fraction, unless it is that of a mirror.
void read_lobe(const Settings& table, const OpticalSurface& surface, Bsdf& bsdf) {
  for (const NumberKey& key : {surface_key::roughness, surface_key::slope_error}) {
    if (table.has(key) && !any_positive(surface.specular)) {
      throw table.error(key, "no specular fraction", "specular above 0, or refractive_index");
    }
  }
  if (table.has(surface_key::roughness)) {
    if (table.has(surface_key::slope_error)) {
      throw table.error(surface_key::slope_error, "roughness too", "one of the two");
    }
    const double alpha = read_alpha(table);
    bsdf.specular = rough_mirror(alpha);
    bsdf.description = printed("roughness %.3g", std::sqrt(alpha));
  } else if (table.has(surface_key::slope_error)) {
    read_slope_error(table, bsdf);
  }
}

// Reads the heat radiation of both sides of a sheet.
void read_heat(const Settings& table, SheetOptics& sheet) {
  const double reemitted = table.get(surface_key::reemitted);
  const double front = table.get(surface_key::emissivity_front);
  const double back = table.get(surface_key::emissivity_back);
  if (reemitted == 0.0) return;
  if (!(front + back > 0.0)) {
    throw table.error(surface_key::emissivity_front, "0 on both sides",
                      "a side that heat can leave from");
  }
  const auto heat = [&](OpticalSurface& surface) {
    Bsdf bsdf = surface.bsdf ? *surface.bsdf : Bsdf{};
    bsdf.reemitted = reemitted;
    bsdf.front_emission = front / (front + back);
    bsdf.description +=
        (bsdf.description.empty() ? "" : ", ") + printed("reemitted %.3g", reemitted);
    surface.bsdf = std::make_shared<const Bsdf>(std::move(bsdf));
  };
  heat(sheet.front);
  if (sheet.back) heat(*sheet.back);
}

// Reads scattering from a table instead of fractions.
OpticalSurface read_measured(const Settings& table, int bands, const std::string& name,
                             const SurfaceFiles& files, std::vector<std::string>& notices) {
  using namespace surface_key;
  for (const NumberKey& key : {absorptance, specular, diffuse, transmittance, retroreflectance,
                               roughness, surface_key::slope_error, refractive_index}) {
    if (table.has(key)) throw table.error(key, "brdf_file too", "the table alone");
  }
  const std::string file = table.get(brdf_file);
  const std::optional<std::string> text = files ? files(file) : std::nullopt;
  if (!text)
    throw table.error(brdf_file, "\"" + file + "\"",
                      "an existing file, relative to the folder of the experiment");
  BandValues scale{};
  std::fill_n(scale.begin(), bands, 1.0);
  if (table.has(brdf_scale)) scale = read_band_values(table, brdf_scale, bands);
  const BrdfTable scattering = read_brdf(*text, file);
  if (const auto notice = coverage_notice(scattering)) notices.push_back(file + ": " + *notice);
  MeasuredSurface measured = measured_surface(name, scattering, scale);
  if (measured.largest_reflectance > 1.0 + sum_tolerance) {
    throw table.error(brdf_file,
                      printed("a reflectance of %.4g at %.4g deg", measured.largest_reflectance,
                              measured.at_incidence_rad / degree_rad),
                      "at most 1 at every angle, or a brdf_scale");
  }
  constexpr double worth_telling = 0.01;
  if (measured.asymmetry > worth_telling) {
    notices.push_back(file + printed(": f(i, o) and f(o, i) differ by %.4g %% (root mean square), "
                                     "against reciprocity; the mean is taken",
                                     100.0 * measured.asymmetry));
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
      surface.*fraction.values = read_band_values(table, fraction.key, bands);
    } else {
      missing.push_back(&fraction);
    }
  }
  const BandValues retroreflected = read_retroreflected(table, bands);
  if (missing.size() == fractions.size() && !any_positive(retroreflected)) {
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
      throw table.error("", printed("fractions that sum to %.12g in band %zu", sum, band),
                        missing.empty() || sum > 1.0
                            ? "a sum of 1"
                            : "a sum of 1, or all but one of " + list(missing) + " too");
    }
    for (const Fraction& fraction : fractions) (surface.*fraction.values)[band] /= sum;
    bsdf.retroreflected[band] = retroreflected[band] / sum;
  }
  if (table.has(surface_key::refractive_index)) return read_glass(table, surface);
  read_lobe(table, surface, bsdf);
  if (any_positive(bsdf.retroreflected)) {
    bsdf.description += (bsdf.description.empty() ? "" : ", ") +
                        printed("retroreflectance %.3g", bsdf.retroreflected[0]);
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
    return settings.has(surface_key::brdf_file)
               ? read_measured(settings, bands, called, files, sheet.notices)
               : read_surface(settings, bands, called);
  };
  sheet.front = side(table, name);
  if (table.has(surface_key::back))
    sheet.back = side(table.get(surface_key::back), name + " (back)");
  read_heat(table, sheet);
  return sheet;
}

std::vector<Key> sheet_keys() {
  using namespace surface_key;
  const std::vector<Key> side = {absorptance,
                                 specular,
                                 diffuse,
                                 transmittance,
                                 retroreflectance,
                                 roughness,
                                 surface_key::slope_error,
                                 slope_error_shape,
                                 slope_error_axis,
                                 refractive_index,
                                 brdf_file,
                                 brdf_scale};
  return joined({side, {back.of(side), reemitted, emissivity_front, emissivity_back}});
}

}  // namespace photorque
