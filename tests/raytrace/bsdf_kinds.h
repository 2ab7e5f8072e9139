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
#include "raytrace/surfaces/mirrors.h"

namespace photorque::fixtures {

struct SurfaceKind {
  std::string name;
  OpticalSurface surface;
  bool smooth;  // f(i, o) varies slowly enough for a quadrature over the hemisphere
};

// f(i, o) without delta functions (mirror, straight on, retroreflection), in the frame of the hit.
inline double scattering_1_sr(const OpticalSurface& surface, double cosine, const Vec3& out,
                              size_t band) {
  const PowerFractions fractions = fractions_of(surface, cosine, band);
  const Bsdf none, &bsdf = surface.bsdf ? *surface.bsdf : none;
  double f = 0.0;
  if (bsdf.specular) f += fractions.specular * bsdf.specular->density(cosine, out) / out.z();
  f += fractions.diffuse * (bsdf.diffuse ? bsdf.diffuse->density(cosine, out) / out.z() : 1.0 / pi);
  return f;
}

inline OpticalSurface with_lobe(double specular, double diffuse, std::shared_ptr<const Lobe> lobe) {
  OpticalSurface surface = grey_surface("s", specular, diffuse);
  surface.bsdf = std::make_shared<const Bsdf>(
      Bsdf{.law = nullptr, .specular = std::move(lobe), .diffuse = nullptr});
  return surface;
}

// A mirror with slope errors along a slanted axis and across it.
inline OpticalSurface uneven_slopes(double specular, double first_rad, double second_rad,
                                    SlopeShape shape) {
  OpticalSurface surface = grey_surface("s", specular, 0.0);
  Bsdf bsdf;
  bsdf.specular = slope_error(first_rad, second_rad, shape);
  bsdf.axis = Vec3(0.6, 0.8, 0.0);
  surface.bsdf = std::make_shared<const Bsdf>(bsdf);
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
  return {
      {"mirror", grey_surface("s", kept, 0.0), false},
      {"matt", grey_surface("s", 0.0, kept), true},
      {"sheet", grey_surface("s", 0.2 * kept, 0.3 * kept, 0.5 * kept), true},
      {"retroreflector", retroreflector(0.75 * kept, 0.25 * kept), true},
      {"rough mirror 0.04", with_lobe(kept, 0.0, rough_mirror(0.04)), false},
      {"rough mirror 0.3", with_lobe(0.7 * kept, 0.3 * kept, rough_mirror(0.3)), true},
      {"rough mirror 1", with_lobe(kept, 0.0, rough_mirror(1.0)), true},
      {"slope error 4 mrad", with_lobe(kept, 0.0, slope_error(0.004)), false},
      {"slope error 50 mrad", with_lobe(kept, 0.0, slope_error(0.05)), false},
      {"slope error 50 mrad, pillbox", with_lobe(kept, 0.0, slope_error(0.05, SlopeShape::pillbox)),
       false},
      {"slope error 50 and 20 mrad", uneven_slopes(kept, 0.05, 0.02, SlopeShape::gaussian), false},
      {"glass over matt", behind_glass(grey_surface("s", 0.0, kept), 1.5), true},
      {"glass over cell", behind_glass(grey_surface("s", kept, 0.0), 1.5), true},
      {"pane", behind_glass(grey_surface("s", 0.0, 0.0, kept), 1.5), true},
      {"rough glass", behind_glass(grey_surface("s", 0.0, kept), 1.5, 0.25), true},
      {"measured", measured(forward_scatter(kept)), true}};
}

// The light of a hit in its own frame: it comes from direction_at(cosine).
inline Incidence incidence_at(double cosine) {
  return {-direction_at(cosine), Vec3::UnitZ()};
}

// The expected direction of everything that leaves, times its fraction of the power: for power P in
// `band` the momentum flow that leaves is P/c times this. Frame of the hit.
inline Vec3 first_moment(const OpticalSurface& surface, double cosine, size_t band) {
  const PowerFractions fractions = fractions_of(surface, cosine, band);
  Vec3 moment = Vec3::Zero();
  for (const Component component : components) {
    moment += mean_flow(surface, component, incidence_at(cosine), fractions.of(component));
  }
  return moment;
}

// Where one ray goes, in the frame of the hit; zero if it is absorbed. Transmitted light counts as
// going up: as much comes from below.
inline Vec3 send_ray(const OpticalSurface& surface, double cosine, const Draw& draw) {
  const PowerFractions fractions = fractions_of(surface, cosine, 0);
  double at = draw.extra(1u << 30);
  for (const Component component : components) {
    at -= fractions.of(component);
    if (at >= 0) continue;
    const Vec3 out = scattered_direction(surface, component, incidence_at(cosine), draw);
    return component == Component::transmitted ? Vec3(-out) : out;
  }
  return Vec3::Zero();
}

inline Draw random_draw(uint64_t index) {
  return {unit_interval(hash_words(index, 1)), unit_interval(hash_words(index, 2)),
          hash_words(index, 3)};
}

}  // namespace photorque::fixtures
