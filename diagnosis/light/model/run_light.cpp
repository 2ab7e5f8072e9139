// The light on the places of a recording: fields of lamps and walls, their sum, and effects on the
// sum.
#include <algorithm>
#include <cmath>

#include "diagnosis/light/model/run.h"

namespace photorque {
namespace {

// Light is a sum of fields times factors.
struct LightTerm {
  const LampField* field;
  double factor;
};
using LightTerms = std::vector<LightTerm>;

LightTerms light_terms_of(const LightState& state, const LightFields& fields) {
  LightTerms terms;
  const auto power = [&](size_t lamp) { return state.power * state.lamp_power[lamp]; };
  for (size_t l = 0; l < fields.lamps.size(); ++l) {
    terms.push_back({fields.lamps[l].field.get(), power(l)});
  }
  for (const WallReflection& share : state.walls) {
    for (const bool specular : {false, true}) {
      const double part = specular ? share.specular : share.diffuse;
      const auto found = fields.walls.find({share.wall, specular});
      if (part == 0.0 || found == fields.walls.end()) continue;
      for (size_t l = 0; l < found->second.size(); ++l) {
        terms.push_back({found->second[l].field.get(), part * power(l)});
      }
    }
  }
  return terms;
}

void add_light(const LightTerms& terms, std::vector<double>& light) {
  for (const auto& [field, factor] : terms) {
    if (factor == 0.0) continue;
    for (size_t o = 0; o < light.size(); ++o) light[o] += factor * (*field)[o];
  }
}

}  // namespace

LightFields LightRun::part(const LightFields& fields, const std::vector<size_t>& rows) {
  const auto some = [&](const LightFields::Part& whole) {
    auto field = std::make_shared<LampField>();
    field->reserve(rows.size());
    for (const size_t row : rows) field->push_back((*whole.field)[row]);
    return LightFields::Part{whole.geometry, std::move(field)};
  };
  LightFields result;
  for (const LightFields::Part& lamp : fields.lamps) result.lamps.push_back(some(lamp));
  for (const auto& [key, parts] : fields.walls) {
    for (const LightFields::Part& one : parts) result.walls[key].push_back(some(one));
  }
  return result;
}

LightFields LightRun::fields(const LightState& state, const LightFields* near, Walls walls) const {
  LightFields result;
  std::shared_ptr<const LampSet> lamps;
  const auto lamp_set = [&]() -> const LampSet& {
    if (!lamps) lamps = lab_->lamps_with(state.divergence);
    return *lamps;
  };
  for (size_t l = 0; l < lab_->lamps(); ++l) {
    LampGeometry geometry = geometry_of(state, l, sites_.enters_cells);
    if (near != nullptr && near->lamps[l].geometry == geometry) {
      result.lamps.push_back(near->lamps[l]);
      continue;
    }
    // Interpolated runs are evaluated at knots, for which the field per output is not known.
    std::optional<KnownField> known;
    if (near != nullptr && between_.empty()) {
      known = {&near->lamps[l].geometry, near->lamps[l].field.get()};
    }
    auto field = std::make_shared<const LampField>(
        expanded(lamp_field(*lab_, lamp_set(), sites_, geometry, known)));
    result.lamps.push_back({std::move(geometry), std::move(field)});
  }
  // Light from walls is slow to compute and is reused while the lamps are unchanged.
  std::vector<LampGeometry> geometries;
  for (size_t l = 0; l < lab_->lamps(); ++l) geometries.push_back(geometry_of(state, l, false));
  if (near != nullptr) {
    for (const auto& [key, parts] : near->walls) {
      const bool same = walls == Walls::kept ||
                        std::ranges::equal(parts, geometries, {}, &LightFields::Part::geometry);
      if (same) result.walls[key] = parts;
    }
  }
  for (const WallReflection& share : state.walls) {
    for (const bool specular : {false, true}) {
      const double part = specular ? share.specular : share.diffuse;
      const auto key = std::pair(share.wall, specular);
      if (part == 0.0 || result.walls.contains(key)) continue;
      std::vector<LampField> by_lamp =
          wall_fields(*lab_, lamp_set(), sites_, geometries, share.wall,
                      specular ? nullptr : exchange_[share.wall].get());
      for (size_t l = 0; l < geometries.size(); ++l) {
        result.walls[key].push_back(
            {geometries[l], std::make_shared<const LampField>(expanded(std::move(by_lamp[l])))});
      }
    }
  }
  return result;
}

std::vector<double> LightRun::light(const LightState& state, const LightFields& fields,
                                    const KnownLight* near) const {
  const LightTerms now = light_terms_of(state, fields);
  if (near != nullptr) {
    const LightTerms before = light_terms_of(*near->state, *near->fields);
    LightTerms changes;
    for (size_t i = 0; i < now.size() && before.size() == now.size(); ++i) {
      if (now[i].field == before[i].field) {
        if (now[i].factor == before[i].factor) continue;
        changes.push_back({now[i].field, now[i].factor - before[i].factor});
      } else {
        changes.push_back(now[i]);
        changes.push_back({before[i].field, -before[i].factor});
      }
    }
    if (before.size() == now.size() && changes.size() < now.size()) {
      std::vector<double> light = *near->light;
      add_light(changes, light);
      return light;
    }
  }
  std::vector<double> light(circumstances_.size(), 0.0);
  add_light(now, light);
  return light;
}

std::vector<double> LightRun::signals_of(const LightState& state, std::vector<double> light) const {
  const size_t cells = lab_->cells().size();
  const std::vector<const CellModel*> models = lab_->models();
  for (size_t o = 0; o < light.size(); ++o) {
    const SampleConditions& c = circumstances_[o];
    if (!recording_.lamp_light.empty()) light[o] *= recording_.lamp_light[o / cells];
    if (is_run() && state.droop_depth != 0.0) {
      light[o] *= 1.0 - state.droop_depth * (1.0 - std::exp(-c.time_s / state.droop_time_s));
    }
    light[o] += state.ambient_W_m2;
    for (const auto& law : state.light_laws) light[o] *= std::max(0.0, law(c));
    if (is_scan()) {
      if (cell_of_point_[o] < cells) light[o] *= state.cell_light[cell_of_point_[o]];
      light[o] *= state.detector_gain;
      continue;
    }
    const size_t k = o % cells;
    const CellModel& model = *models[k];
    const double warm_K = c.temperature_K - model.reference.temperature_K;
    const double warmth = std::max(
        0.0, photocurrent_factor(model, c.temperature_K) + state.photocurrent_per_K * warm_K);
    light[o] *= state.cell_light[k] * state.soiling * state.cell_current[k] * warmth *
                lab_->cells()[k].photocurrent_factor * lab_->responsivity_A_W() *
                lab_->cells()[k].area_m2;
    light[o] = std::max(0.0, light[o]);
  }
  return light;
}

}  // namespace photorque
