#include "scenes/surface_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace photorque {
namespace {

constexpr double sum_tolerance = 1e-9;

// One of the four fractions: its key, and where it goes.
struct Share {
  const char* key;
  BandValues OpticalSurface::*values;
};
constexpr std::array<Share, 4> shares = {{{"absorptance", &OpticalSurface::absorbed},
                                          {"specular", &OpticalSurface::specular},
                                          {"diffuse", &OpticalSurface::diffuse},
                                          {"transmittance", &OpticalSurface::transmitted}}};

// One number for all bands, or an array with one per band.
BandValues read_share(const Settings& table, const char* key, int bands) {
  BandValues values{};
  if (!table.raw(key).is_array()) {
    std::fill_n(values.begin(), bands, table.number(key, Range::fraction()));
    return values;
  }
  const std::vector<double> numbers = table.numbers(key, Range::fraction());
  if (numbers.size() != static_cast<size_t>(bands)) {
    throw table.error(key, "an array of " + std::to_string(numbers.size()),
                      "one number, or one for each of " + std::to_string(bands) + " band(s)");
  }
  std::copy(numbers.begin(), numbers.end(), values.begin());
  return values;
}

std::string sum_text(double sum, size_t band) {
  std::ostringstream text;
  text.precision(12);
  text << "fractions that sum to " << sum << " in band " << band;
  return text.str();
}

std::string list(const std::vector<const Share*>& some) {
  std::string text;
  for (const Share* share : some) text += (text.empty() ? "" : ", ") + std::string(share->key);
  return text;
}

}  // namespace

OpticalSurface read_surface(const Settings& table, int bands, std::string name) {
  OpticalSurface surface;
  surface.name = std::move(name);
  std::vector<const Share*> missing;
  for (const Share& share : shares) {
    if (table.has(share.key)) {
      surface.*share.values = read_share(table, share.key, bands);
    } else {
      missing.push_back(&share);
    }
  }
  if (missing.size() == shares.size()) throw table.error("", "no optical property", list(missing));
  for (size_t band = 0; band < static_cast<size_t>(bands); ++band) {
    double sum = 0.0;
    for (const Share& share : shares) sum += (surface.*share.values)[band];
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
    for (const Share& share : shares) (surface.*share.values)[band] /= sum;
  }
  return surface;
}

SheetOptics read_sheet(const Settings& table, int bands, const std::string& name) {
  SheetOptics sheet{read_surface(table, bands, name), std::nullopt};
  if (table.has("back")) sheet.back = read_surface(table.table("back"), bands, name + " (back)");
  return sheet;
}

}  // namespace photorque
