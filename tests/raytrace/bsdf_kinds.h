// One surface of every kind that scatters, and rays sent through it one by one.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/constants.h"
#include "raytrace/surfaces/bsdf.h"
#include "raytrace/surfaces/ggx.h"
#include "raytrace/surfaces/glass.h"
#include "raytrace/surfaces/measured_brdf.h"
#include "raytrace/surfaces/rough_mirror.h"
#include "raytrace/surfaces/slope_error.h"

namespace photorque::testing {

struct SurfaceKind {
  std::string name;
  OpticalSurface surface;
  bool smooth;  // f(i, o) varies slowly enough for a quadrature over the hemisphere
};

inline OpticalSurface with_lobe(double specular, double diffuse, std::shared_ptr<const Lobe> lobe) {
  OpticalSurface surface = grey_surface("s", specular, diffuse);
  surface.bsdf = std::make_shared<const Bsdf>(
      Bsdf{.law = nullptr, .specular = std::move(lobe), .diffuse = nullptr});
  return surface;
}

inline OpticalSurface retroreflector(double retroreflected, double diffuse) {
  OpticalSurface surface = grey_surface("s", 0.0, diffuse);
  Bsdf bsdf;
  bsdf.retroreflected.fill(retroreflected);
  for (double& absorbed : surface.absorbed) absorbed -= retroreflected;
  surface.bsdf = std::make_shared<const Bsdf>(bsdf);
  return surface;
}

// f(θ_i, θ_o, φ) on nodes that are `step_deg` apart.
template <typename Brdf>
BrdfTable tabulated(double step_deg, const Brdf& brdf) {
  BrdfTable table;
  for (int i = 0; i * step_deg <= 90.0; ++i) {
    table.incidence_rad.push_back(i * step_deg * degree_rad);
  }
  table.scatter_rad = table.incidence_rad;
  for (int i = 0; i * step_deg <= 180.0; ++i) {
    table.azimuth_rad.push_back(i * step_deg * degree_rad);
  }
  for (const double in : table.incidence_rad) {
    for (const double out : table.scatter_rad) {
      for (const double azimuth : table.azimuth_rad) {
        table.brdf_1_sr.push_back(brdf(in, out, azimuth));
      }
    }
  }
  return table;
}

// Scatters forward and keeps its reflectance at every angle: what cos φ adds on one side it takes
// on the other, between nodes too.
inline BrdfTable forward_scatter(double kept) {
  return tabulated(15.0, [&](double in, double out, double azimuth) {
    return kept / pi * (1.0 + 0.8 * std::cos(azimuth) * std::sin(in) * std::sin(out));
  });
}

inline OpticalSurface measured(const BrdfTable& table) {
  BandValues scale{};
  scale[0] = 1.0;
  return measured_surface("s", table, scale).surface;
}

// All kinds; of what meets them (or gets through the glass) a fraction `kept` is not absorbed.
inline std::vector<SurfaceKind> surface_kinds(double kept) {
  return {{"mirror", grey_surface("s", kept, 0.0), false},
          {"matt", grey_surface("s", 0.0, kept), true},
          {"sheet", grey_surface("s", 0.2 * kept, 0.3 * kept, 0.5 * kept), true},
          {"retroreflector", retroreflector(0.75 * kept, 0.25 * kept), true},
          {"rough mirror 0.04", with_lobe(kept, 0.0, rough_mirror(0.04)), false},
          {"rough mirror 0.3", with_lobe(0.7 * kept, 0.3 * kept, rough_mirror(0.3)), true},
          {"rough mirror 1", with_lobe(kept, 0.0, rough_mirror(1.0)), true},
          {"slope error 4 mrad", with_lobe(kept, 0.0, slope_error(0.004)), false},
          {"slope error 50 mrad", with_lobe(kept, 0.0, slope_error(0.05)), false},
          {"glass over matt", behind_glass(grey_surface("s", 0.0, kept), 1.5), true},
          {"glass over cell", behind_glass(grey_surface("s", kept, 0.0), 1.5), true},
          {"pane", behind_glass(grey_surface("s", 0.0, 0.0, kept), 1.5), true},
          {"rough glass", behind_glass(grey_surface("s", 0.0, kept), 1.5, 0.25), true},
          {"measured", measured(forward_scatter(kept)), true}};
}

// Where one ray goes, in the frame of the hit; zero if it is absorbed. Transmitted light counts as
// going up: as much comes from below.
inline Vec3 send_ray(const OpticalSurface& surface, double cosine, const Draw& draw) {
  const PowerFractions fractions = fractions_of(surface, cosine, 0);
  const Bsdf* bsdf = surface.bsdf.get();
  const Vec3 in = direction_at(cosine);
  double at = draw.extra(1u << 30);
  if ((at -= fractions.specular) < 0) {
    return bsdf && bsdf->specular ? bsdf->specular->direction(cosine, draw)
                                  : Vec3(-in.x(), 0, in.z());
  }
  if ((at -= fractions.diffuse) < 0) {
    return bsdf && bsdf->diffuse ? bsdf->diffuse->direction(cosine, draw)
                                 : lambertian_direction(draw.u, draw.v);
  }
  if ((at -= fractions.retroreflected + fractions.transmitted) < 0) return in;
  return Vec3::Zero();
}

inline Draw random_draw(uint64_t index) {
  return {unit_interval(hash_words(index, 1)), unit_interval(hash_words(index, 2)),
          hash_words(index, 3)};
}

}  // namespace photorque::testing
