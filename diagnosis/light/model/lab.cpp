#include "diagnosis/light/model/lab.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/errors.h"
#include "core/numerics/quadrature.h"
#include "core/settings/typed_keys.h"
#include "photovoltaics/cell/response.h"
#include "scenes/effects/stated.h"

namespace photorque {
namespace {

// Keys of [sensors].
namespace noise_key {
constexpr NumberKey irradiance("noise_W_m2", 0.0, Range::not_negative(),
                               "standard deviation of a reading");
constexpr NumberKey relative("relative_noise", 0.0, Range::not_negative(),
                             "additional standard deviation, as a fraction of the reading");
constexpr TableKey of_scans("irradiance", "sensor that scans the irradiance");
constexpr NumberKey voltage("voltage_noise_V", 0.0, Range::not_negative(),
                            "standard deviation of a voltage reading");
constexpr NumberKey current("current_noise_A", 0.0, Range::not_negative(),
                            "standard deviation of a current reading");
constexpr NumberKey tracker_step(
    "tracker_step_V", Range::not_negative(),
    "voltage step of the tracker; its recorded voltage is then an input of the model",
    {.usually = "the tracker is assumed to be at the highest maximum"});
constexpr TableKey of_array("array", "meters of the voltage and the current of the array");
}  // namespace noise_key

}  // namespace

std::vector<Key> light_sensor_keys() {
  using namespace noise_key;
  return {of_scans.of({irradiance, relative}), of_array.of({voltage, current, tracker_step})};
}

LightLab::LightLab(const Experiment& experiment)
    : experiment_(experiment), parts_(light_parts(experiment)) {
  read_noise();
  lamps_ = lamps_with(1.0);
  if (has_array()) place_array();
}

std::shared_ptr<const LampSet> LightLab::lamps_with(double divergence) const {
  if (divergence == 1.0 && lamps_) return lamps_;
  auto set = std::make_shared<LampSet>();
  set->beams = beams_with_divergence(experiment_, divergence);
  std::map<const Emitter*, std::shared_ptr<const DiscLight>> known;
  for (const Beam& beam : set->beams) {
    if (!beam.aperture) {
      throw InputError({experiment_.file.path.string()}, "source", "\"" + beam.name + "\"",
                       "lamps with a round aperture and a rotationally symmetric beam");
    }
    auto& light = known[beam.emitter.get()];
    if (!light) light = std::make_shared<const DiscLight>(*beam.emitter, *beam.aperture);
    set->lights.push_back(light);
  }
  tabulate(*set);
  return set;
}

// Tabulates the heights at which receiver and walls may be in any attitude of the body.
void LightLab::tabulate(LampSet& set) const {
  double reach_m = 0.0;
  for (const double u : {grid().u_low, grid().u_high}) {
    for (const double v : {grid().v_low, grid().v_high}) {
      reach_m = std::max(reach_m, point_body_m(u, v).norm());
    }
  }
  for (const LightWall& wall : walls()) {
    reach_m = std::max(reach_m, wall.centre_m.norm() + wall.radius_m);
  }
  struct Tabulated {
    double low_m = 1e300, high_m = 0.0;
    std::shared_ptr<const LampTable> table = {};
  };
  std::map<const DiscLight*, Tabulated> heights;
  for (size_t l = 0; l < set.beams.size(); ++l) {
    const double away_m = set.beams[l].lab_from_emitter.translation_m.norm();
    Tabulated& h = heights[set.lights[l].get()];
    h.low_m =
        std::min(h.low_m, std::max(3.0 * set.lights[l]->radius_m(), 0.8 * (away_m - reach_m)));
    h.high_m = std::max(h.high_m, 1.1 * (away_m + reach_m));
  }
  for (const auto& light : set.lights) {
    Tabulated& h = heights[light.get()];
    if (!h.table) h.table = std::make_shared<const LampTable>(light, h.low_m, h.high_m);
    set.tables.push_back(h.table);
  }
}

Vec3 LightLab::point_body_m(double u_m, double v_m) const {
  return u_m * grid().u_axis_body + v_m * grid().v_axis_body + parts_.plane_m * grid().normal_body;
}

Vec3 LightLab::middle_body_m() const {
  return point_body_m(0.5 * (grid().u_low + grid().u_high), 0.5 * (grid().v_low + grid().v_high));
}

void LightLab::read_noise() {
  for (const Settings& sensors : experiment_.file.others("sensors")) {
    if (sensors.has(noise_key::of_scans)) {
      const Settings s = sensors.get(noise_key::of_scans);
      noise_.irradiance_W_m2 = s.get(noise_key::irradiance);
      noise_.relative = s.get(noise_key::relative);
      s.finish();
    }
    if (sensors.has(noise_key::of_array)) {
      const Settings s = sensors.get(noise_key::of_array);
      noise_.voltage_V = s.get(noise_key::voltage);
      noise_.current_A = s.get(noise_key::current);
      if (s.has(noise_key::tracker_step)) noise_.tracker_step_V = s.get(noise_key::tracker_step);
      s.finish();
    }
  }
}

void LightLab::place_array() {
  std::vector<WeighedSpectrum> spectra;
  for (const Beam& beam : experiment_.beams) {
    spectra.push_back({beam.spectrum, beam.emitter->power_W()});
  }
  const Bands& bands = experiment_.scene.bands;
  const BandValues by_band = band_responsivity_A_W(design().efficiency, bands, spectra);
  double all_W = 0.0;
  for (const WeighedSpectrum& one : spectra) {
    const BandValues part = band_fractions(one.spectrum, bands);
    for (size_t b = 0; b < static_cast<size_t>(bands.count()); ++b) {
      responsivity_A_W_ += one.power * part[b] * by_band[b];
    }
    all_W += one.power;
  }
  responsivity_A_W_ /= all_W;
  place_cells();
  for (const CellOverride& one : design().overrides) {
    cells_[static_cast<size_t>(one.index)].photocurrent_factor = one.photocurrent_factor;
  }
}

void LightLab::place_cells() {
  const SurfaceGrid& map = grid();
  if (design().places) {
    const double du = (map.u_high - map.u_low) / map.width,
                 dv = (map.v_high - map.v_low) / map.height;
    for (const std::vector<BinPart>& parts : design().places->parts) {
      LightCell cell;
      cell.rectangle = {1e300, -1e300, 1e300, -1e300};
      for (const BinPart& part : parts) {
        const uint32_t width = static_cast<uint32_t>(map.width), column = part.bin % width,
                       row = part.bin / width;
        const double u = map.u_low + du * (column + 0.5), v = map.v_low + dv * (row + 0.5);
        const double area = part.fraction * grid().area_m2[part.bin];
        cell.points_body_m.push_back(point_body_m(u, v));
        cell.weights.push_back(area);
        cell.area_m2 += area;
        cell.rectangle.u_low = std::min(cell.rectangle.u_low, u - 0.5 * du);
        cell.rectangle.u_high = std::max(cell.rectangle.u_high, u + 0.5 * du);
        cell.rectangle.v_low = std::min(cell.rectangle.v_low, v - 0.5 * dv);
        cell.rectangle.v_high = std::max(cell.rectangle.v_high, v + 0.5 * dv);
      }
      for (double& w : cell.weights) w /= cell.area_m2;
      cells_.push_back(std::move(cell));
    }
    return;
  }
  const auto rule = gauss_legendre(points_of_rule());
  for (const CellRectangle& r :
       cell_rectangles(map, design().columns, design().rows, design().gap_m, design().margin_m)) {
    LightCell cell;
    cell.rectangle = r;
    cell.area_m2 = (r.u_high - r.u_low) * (r.v_high - r.v_low);
    for (const auto& [x, wx] : rule) {
      for (const auto& [y, wy] : rule) {
        cell.points_body_m.push_back(
            point_body_m(0.5 * (r.u_low + r.u_high + x * (r.u_high - r.u_low)),
                         0.5 * (r.v_low + r.v_high + y * (r.v_high - r.v_low))));
        cell.weights.push_back(0.25 * wx * wy);
      }
    }
    cells_.push_back(std::move(cell));
  }
}

// If spots are wide compared with cells, few points suffice: for half a cell h and a Gaussian spot
// of standard deviation s, four points err by some 2e-5 (h/s)^8. Shadow edges require many.
size_t LightLab::points_of_rule() const {
  if (!walls().empty()) return 12;
  const Vec3 middle = middle_body_m();
  const double half_m = 0.5 * std::max((grid().u_high - grid().u_low) / design().columns,
                                       (grid().v_high - grid().v_low) / design().rows);
  double narrowest_m = 1e300;
  for (size_t l = 0; l < lamps(); ++l) {
    const double away_m = (lamps_->beams[l].lab_from_emitter.translation_m - middle).norm();
    narrowest_m =
        std::min(narrowest_m, away_m * std::tan(std::min(1.5, lamps_->lights[l]->half_flux_rad())));
  }
  const double ratio =
      half_m / (narrowest_m / 1.1774);  // half of the flux is within 1.18 deviations
  return ratio < 1.1 ? 4 : ratio < 2.2 ? 6 : 12;
}

double LightLab::narrowest_edge_m() const {
  const Vec3 middle = middle_body_m();
  constexpr int steps = 100;
  constexpr double widest_rad = 1.5, steepest_of_gaussian = 0.60653;  // e^(−1/2)
  double narrowest_m = 1e300;
  for (size_t l = 0; l < lamps(); ++l) {
    const double away_m = (lamps_->beams[l].lab_from_emitter.translation_m - middle).norm();
    const double reach_m =
        2.0 * away_m * std::tan(std::min(widest_rad, lamps_->lights[l]->half_flux_rad()));
    double last = 0.0, brightest = 0.0, steepest = 0.0;
    for (int k = 0; k <= steps; ++k) {
      const double E =
          lamps_->tables[l]->irradiance_W_m2({reach_m * k / steps, 0.0, away_m}, -Vec3::UnitZ());
      if (k > 0) steepest = std::max(steepest, std::abs(E - last) * steps / reach_m);
      brightest = std::max(brightest, E);
      last = E;
    }
    if (steepest > 0.0) {
      narrowest_m = std::min(narrowest_m, steepest_of_gaussian * brightest / steepest);
    }
  }
  return narrowest_m;
}

std::vector<const CellModel*> LightLab::models() const {
  std::vector<const CellModel*> models;
  for (size_t i = 0; i < cells_.size(); ++i) {
    const CellOverride* one = design().override_of(i);
    models.push_back(one != nullptr ? &one->model : &design().cell);
  }
  return models;
}

CellTables LightLab::cell_laws(double temperature_K, double leak_S, bool tabulated) const {
  constexpr double largest_A_m2 =
      2000.0;  // five suns on silicon; the exact solution is used beyond
  struct Kind {
    const CellModel* model;
    double area_m2;
    std::shared_ptr<const DiodeVoltageLaw> law;
  };
  std::vector<Kind> kinds;
  CellTables laws;
  const std::vector<const CellModel*> all = models();
  for (size_t i = 0; i < all.size(); ++i) {
    const double area_m2 = cells_[i].area_m2;
    auto kind = std::ranges::find_if(kinds, [&](const Kind& k) {
      return k.model == all[i] && std::abs(k.area_m2 - area_m2) <= 1e-9 * area_m2;
    });
    if (kind == kinds.end()) {
      const CellParameters p = with_leak(parameters_at(*all[i], area_m2, temperature_K), leak_S);
      kinds.push_back(
          {all[i], area_m2, diode_voltage_law(p, tabulated ? largest_A_m2 * area_m2 : 0.0)});
      kind = std::prev(kinds.end());
    }
    laws.push_back(kind->law);
  }
  return laws;
}

}  // namespace photorque
