// The catalogue of disturbances: the kinds of [[disturbance]] in an experiment file.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "attitude/disturbances/screening.h"
#include "attitude/model/disturbance.h"
#include "core/settings/keys.h"

namespace photorque {

struct TrackingCamera;  // attitude/camera/tracking_camera.h

// The parts of an experiment that a reader may use besides its own settings.
struct DisturbanceContext {
  const Platform& platform;
  const Environment& environment;
  const TrackingCamera* camera = nullptr;  // that sees markers; null: there is none
};

// Properties of a kind for `budget`.
struct BudgetTraits {
  std::string paper_figure = {};    // its published figure, by name (paper_figures.h); empty: none
  std::string reason_against = {};  // why it is not ranked; empty: it is
};

// All properties of a kind of disturbance are in its file; no other file uses its name.
struct DisturbanceKind {
  std::string name;     // "bearing_drag"
  std::string summary;  // one sentence of physics
  // Builds the disturbance from its table. InputError for a missing key or a value out of range;
  // the caller has read `kind`, and reports keys that were not read.
  Disturbance (*read)(const Settings& settings, const DisturbanceContext& context) = nullptr;
  Screening screening = {};
  BudgetTraits budget = {};
  // The table of [sensors] that may hold the kind's key as well; empty: no error of an instrument.
  std::string instrument = {};
  bool has_eclipses = false;  // the light may fail, which a run reports
  // The quantity that it sets for all others, in words: of the kinds that set the same only one
  // acts, and once.
  std::string sets = {};
  // The keys that `read` reads, for documents, editors and `check`; beside `kind`.
  std::vector<Key> keys = {};
};

// DisturbanceKind::read of a law that needs its keys alone.
template <class LawType, Stage stage, const auto&... keys>
Disturbance read_law([[maybe_unused]] const Settings& settings, const DisturbanceContext&) {
  return make_disturbance<LawType>({parameters_of(settings, keys)...}, stage);
}

// All kinds, generated from CMakeLists.txt.
std::vector<DisturbanceKind> all_disturbance_kinds();
// All kinds, made once.
const std::vector<DisturbanceKind>& disturbance_kinds();
// The kind of that name; null if there is none (an empirical law has no kind).
const DisturbanceKind* find_kind(const std::string& name);

// One [[disturbance]]: the kind that `kind` names. InputError for an unknown kind.
Disturbance read_disturbance(const Settings& settings, const DisturbanceContext& context);
// All of `root`'s [[disturbance]], in their order.
std::vector<Disturbance> read_disturbances(const Settings& root, const DisturbanceContext& context);

// A disturbance from values in the units of their keys, as if an experiment file had held them:
//   make_disturbance_of("static_unbalance", {{"offset_m", {0, 0, -3e-5}}}, context)
// A single value makes a number, more make an array.
Disturbance make_disturbance_of(
    const std::string& kind, const std::vector<std::pair<std::string, std::vector<double>>>& values,
    const DisturbanceContext& context);

// [[disturbance]] as it is declared: `kind` with the keys of every kind.
Key disturbance_table();

// The first number of `key`, which may be written in another unit than the parameter's own; for
// copies that are edited. NumericalError if the disturbance has no such parameter.
size_t index_of(const Disturbance& disturbance, std::string_view key);
Parameter& parameter_of(Disturbance& disturbance, std::string_view key);
const Parameter& parameter_of(const Disturbance& disturbance, std::string_view key);
// Three numbers of one key.
Vec3 vector_of(const Disturbance& disturbance, std::string_view key);
void set_vector(Disturbance& disturbance, std::string_view key, const Vec3& value_SI);
// The state of that name.
ExtraState& state_of(Disturbance& disturbance, std::string_view name);
const ExtraState& state_of(const Disturbance& disturbance, std::string_view name);

}  // namespace photorque
