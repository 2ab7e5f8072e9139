#include "photovoltaics/cell/front.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "raytrace/surfaces/glass.h"

namespace photorque {
namespace {

namespace cover_key {
constexpr NumberKey refractive_index("refractive_index", CellFront{}.index, {1.0, 10.0},
                                     "refractive index of the cover glass");
constexpr NumberKey coating_index("coating_index", {1.0, 10.0},
                                  "refractive index of a film on the glass, for the mean "
                                  "wavelength of each band; with `coating_thickness_m`",
                                  {.usually = "no film"});
constexpr NumberKey coating_thickness("coating_thickness_m", Range::positive(),
                                      "thickness of the film", {.optional = true});
constexpr NumbersKey angle("angle_deg", {0.0, 0.5 * pi},
                           "instead of glass and film: angles of incidence from 0, in rising order",
                           {.optional = true});
constexpr NumbersKey transmittance("transmittance", Range::fraction(),
                                   "T at each of these angles; only ratios matter",
                                   {.optional = true});
constexpr FlagKey cosine_twice(
    "cosine_twice", false,
    "instead of all these, T = cos θ: the cosine that the light on the cells already contains is "
    "applied again; for the figures of the paper ([paper.md](paper.md)), not for real cells");
}  // namespace cover_key

// Reflected amplitudes at the boundary between a medium of index n, with cosine c, and another one.
struct BoundaryAmplitudes {
  double across, within;  // electric field across and within the plane of incidence

  BoundaryAmplitudes(double n, double c, double n_beyond, double c_beyond)
      : across((n * c - n_beyond * c_beyond) / (n * c + n_beyond * c_beyond)),
        within((n_beyond * c - n * c_beyond) / (n_beyond * c + n * c_beyond)) {}
};

double film_power(double above, double below, double cos_phase) {
  const double both = 2.0 * above * below * cos_phase;
  return (above * above + below * below + both) / (1.0 + above * above * below * below + both);
}

double table_at(const std::vector<double>& angle_rad, const std::vector<double>& transmittance,
                double angle) {
  const auto above = std::ranges::upper_bound(angle_rad, angle);
  const auto i = static_cast<size_t>(above - angle_rad.begin());
  const bool last = above == angle_rad.end();
  const double high_rad = last ? 0.5 * pi : *above, high = last ? 0.0 : transmittance[i];
  if (!(high_rad > angle_rad[i - 1])) return transmittance[i - 1];
  const double t = std::min(1.0, (angle - angle_rad[i - 1]) / (high_rad - angle_rad[i - 1]));
  return std::lerp(transmittance[i - 1], high, t);
}

void read_front_table(const Settings& cover, CellFront& front) {
  for (const std::string_view key :
       {cover_key::refractive_index.name, cover_key::coating_index.name,
        cover_key::coating_thickness.name}) {
    if (cover.has(key)) throw cover.error(key, "a table by angle too", "one of the two");
  }
  front.angle_rad = cover.get(cover_key::angle);
  front.transmittance = cover.get(cover_key::transmittance);
  const bool rising =
      std::ranges::adjacent_find(front.angle_rad, std::greater_equal<>()) == front.angle_rad.end();
  if (front.angle_rad.empty() || front.angle_rad[0] != 0.0 || !rising) {
    throw cover.error(cover_key::angle, std::to_string(front.angle_rad.size()) + " angles",
                      "ascending angles from 0");
  }
  if (front.transmittance.size() != front.angle_rad.size()) {
    throw cover.error(cover_key::transmittance,
                      std::to_string(front.transmittance.size()) + " numbers",
                      std::to_string(front.angle_rad.size()) + ", one per angle");
  }
  // The transmittance is relative to normal incidence.
  constexpr double least = 1e-3;
  if (front.transmittance[0] < least) {
    throw cover.error(cover_key::transmittance,
                      "a first of " + std::to_string(front.transmittance[0]),
                      "at least 0.001 at 0 deg");
  }
}

}  // namespace

double film_reflectance(double cosine, const FilmCoating& film, double index, double wavelength_m) {
  const double in_film = refracted_cosine(cosine, film.index);
  const double in_glass = refracted_cosine(cosine, index);
  const BoundaryAmplitudes front(1.0, cosine, film.index, in_film);
  const BoundaryAmplitudes back(film.index, in_film, index, in_glass);
  const double phase = 4.0 * pi * film.index * film.thickness_m * in_film / wavelength_m;
  const double cos_phase = std::cos(phase);
  return 0.5 * (film_power(front.across, back.across, cos_phase) +
                film_power(front.within, back.within, cos_phase));
}

double CellFront::transmitted(double cosine, double wavelength_m) const {
  if (cosine_twice) return std::max(cosine, 0.0);
  if (!angle_rad.empty()) {
    return table_at(angle_rad, transmittance, std::acos(std::clamp(cosine, 0.0, 1.0)));
  }
  if (coating && cosine > 0.0) return 1.0 - film_reflectance(cosine, *coating, index, wavelength_m);
  return cosine > 0.0 ? 1.0 - fresnel_reflectance(cosine, index) : 0.0;
}

CellFront read_cell_front(const Settings& cover) {
  CellFront front;
  front.cosine_twice = cover.get(cover_key::cosine_twice);
  if (front.cosine_twice) {
    using namespace cover_key;
    for (const std::string_view key : {refractive_index.name, coating_index.name,
                                       coating_thickness.name, angle.name, transmittance.name}) {
      if (cover.has(key)) throw cover.error(key, "a front beside cosine_twice", "one of the two");
    }
    return front;
  }
  if (cover.has(cover_key::angle)) {
    read_front_table(cover, front);
    return front;
  }
  front.index = cover.get(cover_key::refractive_index);
  if (cover.has(cover_key::coating_index) || cover.has(cover_key::coating_thickness)) {
    front.coating =
        FilmCoating{cover.get(cover_key::coating_index), cover.get(cover_key::coating_thickness)};
  }
  return front;
}

std::vector<Key> cell_front_keys() {
  using namespace cover_key;
  return {refractive_index, coating_index, coating_thickness, angle, transmittance, cosine_twice};
}

}  // namespace photorque
