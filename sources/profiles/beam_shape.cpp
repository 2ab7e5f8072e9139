#include "sources/profiles/beam_shape.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/quadrature.h"
#include "core/numerics/root.h"
#include "core/text/format.h"

namespace photorque {
namespace {

constexpr double narrowest_rad = 1e-9;

// Angles from 0 to π in a geometric sequence: every beam has several of them across its width.
std::vector<double> angle_ladder(int steps_per_octave) {
  std::vector<double> ladder = {pi};
  const double ratio = std::exp2(-1.0 / steps_per_octave);
  while (ladder.back() > narrowest_rad) ladder.push_back(ladder.back() * ratio);
  ladder.push_back(0.0);
  std::reverse(ladder.begin(), ladder.end());
  return ladder;
}

}  // namespace

EncircledFlux::EncircledFlux(const Emitter& emitter) : emitter_(emitter) {
  const std::vector<double> ladder = angle_ladder(8);
  double rough_total = 0.0;
  for (size_t i = 0; i + 1 < ladder.size(); ++i) {
    rough_total += flux_between(ladder[i], ladder[i + 1]);
  }
  constexpr double tolerance = 1e-11;
  constexpr int deepest = 40;  // resolves an edge to 1e-12 of its angle
  for (size_t i = 0; i + 1 < ladder.size(); ++i) {
    refine(ladder[i], ladder[i + 1], tolerance * rough_total, deepest);
  }
  double before = 0.0;
  for (Panel& panel : panels_) {
    panel.before = before;
    before += panel.flux;
  }
}

double EncircledFlux::flux_density(double angle_rad) const {
  return 2.0 * pi * std::sin(angle_rad) * emitter_.relative_intensity(angle_rad);
}

double EncircledFlux::flux_between(double low_rad, double high_rad) const {
  return integrate(
      gauss_8, [this](double angle_rad) { return flux_density(angle_rad); }, low_rad, high_rad);
}

void EncircledFlux::refine(double low_rad, double high_rad, double tolerance, int depth) {
  // Compares two quadratures whose nodes leave no common gap, so that they differ for a step of the
  // intensity at any angle.
  const double middle_rad = 0.5 * (low_rad + high_rad);
  const auto density = [this](double angle_rad) { return flux_density(angle_rad); };
  const double flux = flux_between(low_rad, high_rad);
  const double check = integrate(lobatto_8, density, low_rad, middle_rad) +
                       integrate(lobatto_8, density, middle_rad, high_rad);
  if (depth == 0 || std::abs(flux - check) <= tolerance) {
    panels_.push_back({low_rad, high_rad, 0.0, flux});
    return;
  }
  refine(low_rad, middle_rad, tolerance, depth - 1);
  refine(middle_rad, high_rad, tolerance, depth - 1);
}

double EncircledFlux::flux_within(const Panel& panel, double angle_rad) const {
  return panel.before + std::min(panel.flux, flux_between(panel.low_rad, angle_rad));
}

double EncircledFlux::solid_angle_sr() const {
  return panels_.back().before + panels_.back().flux;
}

double EncircledFlux::within(double half_angle_rad) const {
  const double total = solid_angle_sr();
  if (total <= 0.0 || half_angle_rad >= pi) return 1.0;
  const auto panel = std::upper_bound(
      panels_.begin(), panels_.end() - 1, half_angle_rad,
      [](double angle_rad, const Panel& candidate) { return angle_rad < candidate.high_rad; });
  return flux_within(*panel, half_angle_rad) / total;
}

double EncircledFlux::half_angle_rad(double fraction) const {
  const double flux = fraction * solid_angle_sr();
  if (flux <= 0.0) return 0.0;
  const auto panel = std::lower_bound(panels_.begin(), panels_.end() - 1, flux,
                                      [](const Panel& candidate, double wanted) {
                                        return candidate.before + candidate.flux < wanted;
                                      });
  const auto is_within = [&](double angle_rad) { return flux_within(*panel, angle_rad) < flux; };
  return bisect(panel->low_rad, panel->high_rad, is_within, {52}).high;
}

double full_width_rad(const Emitter& emitter, double level) {
  const std::vector<double> ladder = angle_ladder(64);
  const auto reaches = [&](double angle_rad) {
    return emitter.relative_intensity(angle_rad) >= level;
  };
  const auto outermost = std::find_if(ladder.rbegin(), ladder.rend(), reaches);
  if (outermost == ladder.rbegin()) return 2.0 * pi;
  if (outermost == ladder.rend() || *outermost == 0.0) return 0.0;
  return 2.0 * bisect(*outermost, *(outermost - 1), reaches, {52}).low;
}

BeamShape describe(const Emitter& emitter) {
  const EncircledFlux flux(emitter);
  BeamShape shape;
  shape.collimated = flux.solid_angle_sr() <= 0.0;
  shape.fwhm_rad = full_width_rad(emitter, 0.5);
  shape.full_width_tenth_rad = full_width_rad(emitter, 0.1);
  shape.half_angle_50_rad = flux.half_angle_rad(0.5);
  shape.half_angle_86_rad = flux.half_angle_rad(1.0 - std::exp(-2.0));
  shape.half_angle_90_rad = flux.half_angle_rad(0.9);
  shape.within_half_fwhm = flux.within(0.5 * shape.fwhm_rad);
  shape.within_fwhm = flux.within(shape.fwhm_rad);
  return shape;
}

std::string one_line(const std::string& name, const BeamShape& shape) {
  if (shape.collimated) return name + ": collimated, all of the flux along the axis";
  const double half_fwhm_deg = 0.5 * shape.fwhm_rad / degree_rad;
  return name +
         printed(
             ": FWHM %.4g deg, full width at tenth maximum %.4g deg; half-angle of 50 %% of the "
             "flux %.4g deg, 86.5 %% %.4g deg, 90 %% %.4g deg; within ±%.4g deg %.2f %%, within "
             "±%.4g deg %.2f %%",
             shape.fwhm_rad / degree_rad, shape.full_width_tenth_rad / degree_rad,
             shape.half_angle_50_rad / degree_rad, shape.half_angle_86_rad / degree_rad,
             shape.half_angle_90_rad / degree_rad, half_fwhm_deg, 100.0 * shape.within_half_fwhm,
             2.0 * half_fwhm_deg, 100.0 * shape.within_fwhm);
}

namespace {

struct Group {
  const Beam* first;
  int beams;
};

std::vector<Group> different_emitters(std::span<const Beam> beams) {
  std::vector<Group> groups;
  for (const Beam& beam : beams) {
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const Group& group) {
      return group.first->emitter == beam.emitter;
    });
    if (same == groups.end()) {
      groups.push_back({&beam, 1});
    } else {
      ++same->beams;
    }
  }
  return groups;
}

}  // namespace

Table beam_shape_table(std::span<const Beam> beams) {
  Table table =
      Table::of("beam_shapes", "Angular shape of every source",
                {"source", "beams", "power_each_W", "fwhm_deg", "full_width_tenth_deg",
                 "half_angle_50_percent_deg", "half_angle_86_percent_deg",
                 "half_angle_90_percent_deg", "flux_within_half_fwhm", "flux_within_fwhm"});
  for (const Group& group : different_emitters(beams)) {
    const BeamShape shape = describe(*group.first->emitter);
    table.row()
        .set("source", group.first->name)
        .set("beams", group.beams)
        .set("power_each_W", group.first->emitter->power_W())
        .set("fwhm_deg", shape.fwhm_rad / degree_rad)
        .set("full_width_tenth_deg", shape.full_width_tenth_rad / degree_rad)
        .set("half_angle_50_percent_deg", shape.half_angle_50_rad / degree_rad)
        .set("half_angle_86_percent_deg", shape.half_angle_86_rad / degree_rad)
        .set("half_angle_90_percent_deg", shape.half_angle_90_rad / degree_rad)
        .set("flux_within_half_fwhm", shape.within_half_fwhm)
        .set("flux_within_fwhm", shape.within_fwhm);
  }
  return table;
}

std::vector<std::string> beam_shape_lines(std::span<const Beam> beams) {
  std::vector<std::string> lines;
  for (const Group& group : different_emitters(beams)) {
    const std::string times = group.beams > 1 ? " × " + std::to_string(group.beams) : "";
    lines.push_back(one_line(group.first->name + times, describe(*group.first->emitter)));
  }
  return lines;
}

}  // namespace photorque
