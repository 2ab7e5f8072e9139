// Fraction of light that enters the front of a cell, as a function of the angle of incidence.
//
// A cell's external quantum efficiency is measured in perpendicular light and includes the
// reflection at normal incidence. The dependence on the angle is a separate factor, the incidence
// angle modifier
//   K(θ) = T(θ)/T(0),  T the fraction of the light that enters.
#pragma once

#include <optional>
#include <vector>

#include "core/settings/typed_keys.h"

namespace photorque {

// A thin clear film on the glass. Interference occurs in the film but not in the glass.
struct FilmCoating {
  double index = 1.38;          // ≥ 1
  double thickness_m = 132e-9;  // > 0
};

// Either clear glass with the cell directly behind it (unpolarised light, no further reflection),
// or a table.
struct CellFront {
  double index = 1.5;  // ≥ 1
  std::optional<FilmCoating> coating;
  // Instead of both: T as a function of the angle, linear in between and zero at 90 deg.
  std::vector<double> angle_rad;      // ascending from 0
  std::vector<double> transmittance;  // one per angle, in [0, 1], first > 0
  // Instead of all of these: T = cos θ. The light on a cell already contains the cosine, which then
  // counts twice, as in equation 29 of the paper.
  bool cosine_twice = false;

  // T at a cosine in [0, 1] of the angle of incidence. The wavelength affects a coating only.
  double transmitted(double cosine, double wavelength_m) const;
  // The modifier K, which is 1 at normal incidence.
  double modifier(double cosine, double wavelength_m) const {
    return transmitted(cosine, wavelength_m) / transmitted(1.0, wavelength_m);
  }
};

// Reflectance of a film on a thick medium in air, for unpolarised light.
// Source: M. Born and E. Wolf, Principles of Optics, 7th ed., section 1.6.4.
double film_reflectance(double cosine, const FilmCoating& film, double index, double wavelength_m);

// Reads the table `[array.cover]`, and declares its keys.
CellFront read_cell_front(const Settings& cover);
std::vector<Key> cell_front_keys();

}  // namespace photorque
