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

// The parts of an experiment that a reader may use in addition to its table.
struct DisturbanceContext {
  const Platform& platform;
  const Environment& environment;
  const TrackingCamera* camera = nullptr;  // camera with markers; null: none
};

// Properties of a kind for `budget`.
struct BudgetTraits {
  std::string paper_figure = {};    // name of its figure in paper_figures.h; empty: none
  std::string reason_against = {};  // the reason for no ranking; empty: it is ranked
};

// All properties of a kind of disturbance are in its file; no other file uses its name.
struct DisturbanceKind {
  std::string name;     // "bearing_drag"
  std::string summary;  // one sentence of physics
  // Builds the disturbance from its table. InputError for a missing key or a value out of range.
  // The caller reads `kind` and reports keys that were not read.
  Disturbance (*read)(const Settings& settings, const DisturbanceContext& context) = nullptr;
  Screening screening = {};
  BudgetTraits budget = {};
  // The table of [sensors] that may contain the keys too; empty: not an error of an instrument.
  std::string instrument = {};
  bool has_eclipses = false;  // the light may fail; a run reports such events
  // The quantity that it sets for all others, as text. A model may have only one disturbance that
  // sets a quantity.
  std::string sets = {};
  // The keys that `read` reads in addition to `kind`, for documents, editors and `check`.
  std::vector<Key> keys = {};
};

// A kind whose law needs only these keys, with `read` and `keys` added.
template <class LawType, Stage stage, const auto&... law_keys>
DisturbanceKind kind_of_law(DisturbanceKind kind) {
  kind.read = []([[maybe_unused]] const Settings& settings, const DisturbanceContext&) {
    return make_disturbance<LawType>({parameters_of(settings, law_keys)...}, stage);
  };
  kind.keys = {Key(law_keys)...};
  return kind;
}

// DisturbanceKind::read for a key that takes one number, or one for each body axis, with a law for
// each case.
template <class LawOfOne, class LawOfThree, const ScalarKey& key>
Disturbance read_one_or_three(const Settings& settings, const DisturbanceContext&) {
  if (count_as_written(settings, key.name) == 0) {
    return make_disturbance<LawOfOne>({parameters_of(settings, key)});
  }
  return make_disturbance<LawOfThree>({parameters_of(settings, VectorKey(key.name))});
}

// All kinds, generated from CMakeLists.txt.
std::vector<DisturbanceKind> all_disturbance_kinds();
// All kinds, created once.
const std::vector<DisturbanceKind>& disturbance_kinds();
// The kind of that name; null if there is none (an empirical law has no kind).
const DisturbanceKind* find_kind(const std::string& name);

// Reads one [[disturbance]]. InputError for an unknown kind.
Disturbance read_disturbance(const Settings& settings, const DisturbanceContext& context);
// Reads all [[disturbance]] tables of `root` in their order. InputError if two of them set one
// quantity.
std::vector<Disturbance> read_disturbances(const Settings& root, const DisturbanceContext& context);

// A disturbance from values in the units of their keys, as from an experiment file:
//   make_disturbance_of("static_unbalance", {{"offset_m", {0, 0, -3e-5}}}, context)
// A single value is a number, several are an array.
Disturbance make_disturbance_of(
    const std::string& kind, const std::vector<std::pair<std::string, std::vector<double>>>& values,
    const DisturbanceContext& context);

// The table [[disturbance]]: `kind` with the keys of every kind.
Key disturbance_table();

// Index of the first number of `key`, which may be in another unit than the parameter. Needed for
// editing copies. NumericalError if the disturbance has no such parameter.
size_t index_of(const Disturbance& disturbance, std::string_view key);
Parameter& parameter_of(Disturbance& disturbance, std::string_view key);
const Parameter& parameter_of(const Disturbance& disturbance, std::string_view key);
// The three numbers of one key, SI.
Vec3 vector_of(const Disturbance& disturbance, std::string_view key);
void set_vector(Disturbance& disturbance, std::string_view key, const Vec3& value_SI);
// The state of that name; NumericalError if there is none.
ExtraState& state_of(Disturbance& disturbance, std::string_view name);
const ExtraState& state_of(const Disturbance& disturbance, std::string_view name);

}  // namespace photorque
