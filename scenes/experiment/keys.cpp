// Keys that file.cpp and experiment.cpp read.
#include "scenes/experiment/keys.h"

#include "receivers/kind.h"
#include "scenes/experiment/experiment.h"
#include "scenes/surfaces/settings.h"
#include "sources/lamps/kind.h"

namespace photorque {
namespace {

template <class Kind>
std::vector<Key::Choice> choices_of(const std::vector<Kind>& kinds) {
  std::vector<Key::Choice> choices;
  for (const Kind& kind : kinds) choices.push_back({kind.name, kind.summary, kind.keys});
  return choices;
}

std::vector<Key::Choice> unit_choices() {
  std::vector<Key::Choice> choices;
  for (const std::string& unit : cad_units()) choices.push_back({unit});
  return choices;
}

Key scene_table() {
  using namespace scene_key;
  return scene.of({file,
                   Key::choice("unit", unit_choices(),
                               "unit of length of an STL or OBJ file, which states none; required "
                               "for these without `metres_per_unit`, not allowed for glTF")
                       .optional(),
                   up, metres_per_unit, centre_of_rotation, textures, allow_outside, bands});
}

Key material_table() {
  return Key::tables("material",
                     joined({{TextKey("name", "name of a material of the model")}, sheet_keys()}),
                     "optical properties instead of those in the model's file");
}

Key source_table() {
  return Key::tables(
      "source",
      {Key::choice("kind", choices_of(all_source_kinds()), "kind of the source"),
       TextKey("light",
               "name of a lamp in the glTF file, which supplies the keys that are not given",
               {.optional = true})},
      "a lamp, in lab axes");
}

Key receiver_table() {
  const std::vector<ReceiverKind> kinds = all_receiver_kinds();
  size_t flux_map = 0;
  while (kinds[flux_map].name != "flux_map") ++flux_map;
  return Key::tables("receiver",
                     {Key::choice_or("kind", choices_of(kinds), flux_map, "kind of the receiver")},
                     "where light is measured");
}

Key joint_table() {
  return Key::tables("joint", joint_keys(), "a part of the scene that turns about an axis");
}

Key attitude_table() {
  using namespace attitude_key;
  return attitude.of({tilt, heading});
}

Key trace_table() {
  using namespace trace_key;
  const TraceOptions usual;
  return trace_key::trace.of(
      {rays.with_default(static_cast<int64_t>(usual.rays)),
       replicates.with_default(usual.replicates),
       seed.with_default(static_cast<int64_t>(usual.seed)), max_depth.with_default(usual.max_depth),
       cutoff.with_default(usual.cutoff), direct, target_error, max_time, arriving_rays});
}

Key torque_map_table() {
  using namespace torque_map_key;
  const auto of_part = [](const NumberKey& key) {
    NumberKey own = key.usually("that of the whole");
    own.otherwise.reset();
    return own;
  };
  const Key gas = molecular_flow.of(
      {flow_speed, gas_temperature, molar_mass, accommodation, wall_temperature,
       flow_part.of({part_node, of_part(accommodation), of_part(wall_temperature)})});
  return torque_map.of(
      {tilt, heading, azimuth, elevation, azimuth_step, elevation_step, rays, gas});
}

Key camera_table() {
  using namespace camera_key;
  const Camera usual;
  return camera.of({position, target, field_of_view, width.with_default(usual.width),
                    height.with_default(usual.height), lamps});
}

}  // namespace

std::vector<Key> scene_tables() {
  return {scene_table(),    material_table(), source_table(),     receiver_table(), joint_table(),
          attitude_table(), trace_table(),    torque_map_table(), camera_table()};
}

}  // namespace photorque
