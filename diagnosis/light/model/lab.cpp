#include "diagnosis/light/model/lab.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/quadrature.h"
#include "diagnosis/light/model/lamp_table.h"
#include "photovoltaics/cell/response.h"
#include "receivers/maps/flux_map.h"
#include "sources/kind.h"

namespace photorque {
namespace {

InputLocation place_of(const Experiment& experiment) {
  return {experiment.file.path.string()};
}

// A width, times a factor, that a lamp can have: nobody wrote what lies beyond.
double widened(const std::string& key, double value, double factor) {
  if (key == "exponent") return std::min(value / (factor * factor), std::max(value, 1e9));
  constexpr double below = 1.0 - 1e-6;  // 180 deg itself are too many
  const KeyUnit unit = unit_of_key(key);
  const double widest_rad = unit.stem == "half_angle" ? 0.5 * pi : below * pi;
  return std::min(value * factor, std::max(value, widest_rad / unit.to_SI));
}

// The keys of a source with all angular widths multiplied.
void widen(SettingsNode& source, double scale) {
  auto* table = std::get_if<SettingsNode::Table>(&source.value);
  if (table == nullptr) return;
  for (auto& [key, node] : *table) {
    const std::string stem = unit_of_key(key).stem;
    const bool is_width = stem == "fwhm" || stem == "half_angle" || stem == "halo_fwhm";
    if ((!is_width && key != "exponent") || !node.is_number()) continue;
    const double value = std::holds_alternative<double>(node.value)
                             ? std::get<double>(node.value)
                             : static_cast<double>(std::get<int64_t>(node.value));
    node.value = widened(key, value, scale);
  }
}

std::vector<Beam> beams_of(const Experiment& experiment, double scale) {
  if (scale == 1.0) return experiment.beams;
  const std::vector<SourceKind> kinds = all_source_kinds();
  std::vector<Beam> beams;
  for (const Settings& written : experiment.file.others("source")) {
    const auto name = written.text("kind");
    const auto kind = std::find_if(kinds.begin(), kinds.end(),
                                   [&](const SourceKind& k) { return k.name == name; });
    SettingsNode::Table table;
    for (const std::string& key : written.keys()) table[key] = written.raw(key);
    SettingsNode node{table, written.where()};
    widen(node, scale);
    SourceContext context;
    context.scene_radius_m = experiment.scene.radius_m();
    context.folder = experiment.file.path.parent_path();
    const Settings source(std::make_shared<const SettingsNode>(std::move(node)), written.name());
    for (Beam& beam : kind->make(source, context)) beams.push_back(std::move(beam));
  }
  return beams;
}

std::shared_ptr<LampSet> lamp_set(const Experiment& experiment, double scale) {
  auto set = std::make_shared<LampSet>();
  set->beams = beams_of(experiment, scale);
  std::map<const Emitter*, std::shared_ptr<const DiscLight>> known;
  for (const Beam& beam : set->beams) {
    if (!beam.aperture) {
      throw InputError(place_of(experiment), "source", "\"" + beam.name + "\"",
                       "lamps with a round aperture and the same beam all round: no others can be "
                       "diagnosed");
    }
    auto& light = known[beam.emitter.get()];
    if (!light) light = std::make_shared<const DiscLight>(*beam.emitter, *beam.aperture);
    set->lights.push_back(light);
  }
  return set;
}

}  // namespace

LightLab::LightLab(const Experiment& experiment) : experiment_(experiment) {
  find_receiver();
  read_noise();
  find_walls();
  lamps_ = lamps_with(1.0);
  read_array();
}

std::shared_ptr<const LampSet> LightLab::lamps_with(double divergence) const {
  if (divergence == 1.0 && lamps_) return lamps_;
  auto set = lamp_set(experiment_, divergence);
  tabulate(*set);
  return set;
}

// Over the heights at which receiver and walls may stand, whichever way the body is turned.
void LightLab::tabulate(LampSet& set) const {
  double reach_m = 0.0;
  for (const double u : {grid_->u_low, grid_->u_high}) {
    for (const double v : {grid_->v_low, grid_->v_high}) {
      reach_m = std::max(reach_m, point_body_m(u, v).norm());
    }
  }
  for (const LightWall& wall : walls_) {
    reach_m = std::max(reach_m, wall.centre_m.norm() + wall.radius_m);
  }
  struct Heights {
    double low_m = 1e300, high_m = 0.0;
  };
  std::map<const DiscLight*, Heights> heights;
  for (size_t l = 0; l < set.beams.size(); ++l) {
    const double away_m = set.beams[l].lab_from_emitter.translation_m.norm();
    Heights& h = heights[set.lights[l].get()];
    h.low_m =
        std::min(h.low_m, std::max(3.0 * set.lights[l]->radius_m(), 0.8 * (away_m - reach_m)));
    h.high_m = std::max(h.high_m, 1.1 * (away_m + reach_m));
  }
  std::map<const DiscLight*, std::shared_ptr<const LampTable>> known;
  for (const auto& light : set.lights) {
    auto& table = known[light.get()];
    const Heights& h = heights[light.get()];
    if (!table) table = std::make_shared<const LampTable>(light, h.low_m, h.high_m);
    set.tables.push_back(table);
  }
}

void LightLab::find_receiver() {
  const auto arrays = experiment_.file.others("array");
  const std::string wanted = arrays.size() == 1 ? arrays[0].text_or("receiver", "") : "";
  for (const NamedReceiver& named : experiment_.receivers) {
    if (!named.flux_map || (!wanted.empty() && named.name != wanted)) continue;
    grid_ = &named.flux_map->grid();
    receiver_ = named.name;
    break;
  }
  if (grid_ == nullptr || grid_->over != SurfaceGrid::Over::plane) {
    throw InputError(
        place_of(experiment_), "receiver", "no flat flux map",
        "a [[receiver]] of kind \"flux_map\" over a plane, on which light is measured");
  }
  const std::vector<SurfaceFace> faces =
      faces_of(experiment_.scene, grid_->instances, grid_->facing_body);
  plane_m_ = faces.front().corner_body_m[0].dot(grid_->normal_body);
}

Vec3 LightLab::point_body_m(double u_m, double v_m) const {
  return u_m * grid_->u_axis_body + v_m * grid_->v_axis_body + plane_m_ * grid_->normal_body;
}

void LightLab::read_noise() {
  for (const Settings& sensors : experiment_.file.others("sensors")) {
    if (sensors.has("irradiance")) {
      const Settings s = sensors.table("irradiance");
      noise_.irradiance_W_m2 = s.number_or("noise_W_m2", 0.0, Range::not_negative());
      noise_.relative = s.number_or("relative_noise", 0.0, Range::not_negative());
      s.finish();
    }
    if (sensors.has("array")) {
      const Settings s = sensors.table("array");
      noise_.voltage_V = s.number_or("voltage_noise_V", 0.0, Range::not_negative());
      noise_.current_A = s.number_or("current_noise_A", 0.0, Range::not_negative());
      if (s.has("tracker_step_V")) {
        noise_.tracker_step_V = s.number("tracker_step_V", Range::not_negative());
      }
      s.finish();
    }
  }
}

bool is_sheet(const std::vector<std::array<Vec3, 3>>& triangles) {
  constexpr size_t most = 64;
  constexpr double flat = 1e-6;  // of the triangles' size, and of their directions
  if (triangles.empty() || triangles.size() > most) return false;
  const auto area = [](const std::array<Vec3, 3>& t) {
    return Vec3((t[1] - t[0]).cross(t[2] - t[0]));
  };
  const Vec3 first = triangles.front()[0];
  const Vec3 normal = area(triangles.front()).normalized();
  double size_m = 0.0;
  for (const auto& t : triangles) {
    for (const Vec3& p : t) size_m = std::max(size_m, (p - first).norm());
  }
  for (const auto& t : triangles) {
    if (!(normal.dot(area(t)) > (1.0 - flat) * area(t).norm())) return false;
    for (const Vec3& p : t) {
      if (std::abs(normal.dot(p - first)) > flat * size_m) return false;
    }
    // The middle of one within another.
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3.0;
    const auto holds_middle = [&](const std::array<Vec3, 3>& other) {
      if (&other == &t) return false;
      for (size_t k = 0; k < 3; ++k) {
        const Vec3 edge = other[(k + 1) % 3] - other[k];
        if (normal.dot(edge.cross(middle - other[k])) <= 0.0) return false;
      }
      return true;
    };
    if (std::ranges::any_of(triangles, holds_middle)) return false;
  }
  return true;
}

void LightLab::find_walls() {
  const Scene& scene = experiment_.scene;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (std::ranges::find(grid_->instances, i) != grid_->instances.end()) continue;
    LightWall wall;
    wall.node = scene.instances[i].node;
    const uint32_t one[] = {i};
    for (const SurfaceFace& face : faces_of(scene, one)) {
      // What lies behind the receiver neither shades nor lights it.
      const bool above = std::ranges::any_of(face.corner_body_m, [&](const Vec3& p) {
        return p.dot(grid_->normal_body) > plane_m_ + 1e-6;
      });
      if (above) wall.triangles.push_back(face.corner_body_m);
    }
    if (wall.triangles.empty()) continue;
    for (const auto& t : wall.triangles) {
      wall.centre_m += (t[0] + t[1] + t[2]) / (3.0 * static_cast<double>(wall.triangles.size()));
    }
    for (const auto& t : wall.triangles) {
      for (const Vec3& p : t) wall.radius_m = std::max(wall.radius_m, (p - wall.centre_m).norm());
    }
    wall.is_sheet = is_sheet(wall.triangles);
    walls_.push_back(std::move(wall));
  }
}

void LightLab::read_array() {
  const auto arrays = experiment_.file.others("array");
  if (arrays.size() != 1) return;
  design_ = read_array_design(arrays[0], read_cell_places(arrays[0], experiment_.scene, *grid_));
  std::vector<WeighedSpectrum> spectra;
  for (const Beam& beam : experiment_.beams) {
    spectra.push_back({beam.spectrum, beam.emitter->power_W()});
  }
  const Bands& bands = experiment_.scene.bands;
  const BandValues by_band = band_responsivity_A_W(design_->efficiency, bands, spectra);
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
  for (const CellOverride& one : design_->overrides) {
    cells_[static_cast<size_t>(one.index)].photocurrent_factor = one.photocurrent_factor;
  }
}

void LightLab::place_cells() {
  ArrayLight grid;
  grid.width = grid_->width;
  grid.height = grid_->height;
  grid.u_low = grid_->u_low;
  grid.u_high = grid_->u_high;
  grid.v_low = grid_->v_low;
  grid.v_high = grid_->v_high;
  if (design_->places) {
    const double du = (grid.u_high - grid.u_low) / grid.width,
                 dv = (grid.v_high - grid.v_low) / grid.height;
    for (const std::vector<BinPart>& parts : design_->places->parts) {
      LightCell cell;
      cell.rectangle = {1e300, -1e300, 1e300, -1e300};
      for (const BinPart& part : parts) {
        const uint32_t width = static_cast<uint32_t>(grid.width), column = part.bin % width,
                       row = part.bin / width;
        const double u = grid.u_low + du * (column + 0.5), v = grid.v_low + dv * (row + 0.5);
        const double area = part.fraction * grid_->area_m2[part.bin];
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
       cell_rectangles(grid, design_->columns, design_->rows, design_->gap_m, design_->margin_m)) {
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

// Spots that are wide against a cell need few points: with half a cell h and a Gaussian spot of
// standard deviation s, four err by some 2e-5 (h/s)^8. Edges of shadows need many.
size_t LightLab::points_of_rule() const {
  if (!walls_.empty()) return 12;
  const Vec3 middle =
      point_body_m(0.5 * (grid_->u_low + grid_->u_high), 0.5 * (grid_->v_low + grid_->v_high));
  const double half_m = 0.5 * std::max((grid_->u_high - grid_->u_low) / design_->columns,
                                       (grid_->v_high - grid_->v_low) / design_->rows);
  double narrowest_m = 1e300;
  for (size_t l = 0; l < lamps(); ++l) {
    const double away_m = (lamps_->beams[l].lab_from_emitter.translation_m - middle).norm();
    narrowest_m =
        std::min(narrowest_m, away_m * std::tan(std::min(1.5, lamps_->lights[l]->half_flux_rad())));
  }
  const double ratio = half_m / (narrowest_m / 1.1774);  // half of the flux within 1.18 deviations
  return ratio < 1.1 ? 4 : ratio < 2.2 ? 6 : 12;
}

double LightLab::narrowest_edge_m() const {
  const Vec3 middle =
      point_body_m(0.5 * (grid_->u_low + grid_->u_high), 0.5 * (grid_->v_low + grid_->v_high));
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
    const CellOverride* one = design_->override_of(i);
    models.push_back(one != nullptr ? &one->model : &design_->cell);
  }
  return models;
}

LitCells LightLab::lit(double temperature_K, double extra_shunt_S, bool tabulated) const {
  std::vector<double> area_m2;
  for (const LightCell& cell : cells_) area_m2.push_back(cell.area_m2);
  return lit_cells(models(), area_m2, temperature_K, extra_shunt_S, tabulated);
}

size_t LightLab::strings() const {
  return design_ ? design_->wiring.strings.size() : 0;
}

size_t LightLab::bypasses() const {
  size_t count = 0;
  if (!design_) return count;
  for (const ArrayWiring::String& s : design_->wiring.strings) count += s.substrings.size();
  return count;
}

}  // namespace photorque
