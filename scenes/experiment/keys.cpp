// What file.cpp and experiment.cpp read.
#include "scenes/experiment/keys.h"

#include "core/constants.h"
#include "receivers/kind.h"
#include "scenes/experiment/experiment.h"
#include "scenes/surfaces/settings.h"
#include "sources/lamps/kind.h"

namespace photorque {
namespace {

constexpr int64_t most_rays = int64_t{1} << 40;

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
  return Key::table(
      "scene",
      {Key::text("file",
                 "glTF or GLB, beside the experiment; metres, +Y up: glTF (x, y, z) is body "
                 "(x, −z, y). Or STL or OBJ, with `unit`"),
       Key::choice("unit", unit_choices(),
                   "of lengths in an STL or OBJ file, which does not say it; required with these, "
                   "wrong with glTF")
           .optional(),
       Key::choice_or("up", words({"z", "y"}), 0,
                      "of an STL or OBJ file: the axis that is up at zero tilt; z: the file's axes "
                      "are the body's, y: as in glTF"),
       Key::number_or("metres_per_unit", 1.0, Range::positive(),
                      "scale of a glTF file's lengths: 0.001 for a model in millimetres"),
       Key::vector3_or("centre_of_rotation_m", Vec3::Zero(),
                       "where the model has the centre of rotation, in body axes (z up): the model "
                       "is moved so that this point is the origin"),
       Key::flag_or("textures", false,
                    "true: materials that are derived from drawing values take their base colour "
                    "from its picture (PNG, JPEG), as the mean over each triangle"),
       Key::flag_or("allow_outside", false,
                    "true: links and paths of the model out of its folder are followed; also "
                    "`--allow-outside`"),
       Key::numbers("bands_nm", Range::not_negative(),
                    "edges of 1 to 8 wavelength bands, rising; all light must fall inside")
           .usually_is("one band over everything")},
      "the model that is lit");
}

Key material_table() {
  return Key::tables("material", joined({{Key::text("name", "of a glTF material")}, sheet_keys()}),
                     "optical properties instead of those in the model's file");
}

Key source_table() {
  return Key::tables(
      "source",
      {Key::choice("kind", choices_of(all_source_kinds()), "what shines"),
       Key::text("light", "a lamp that the scene's glTF file places: what is not given here is its")
           .optional()},
      "a lamp, in lab axes");
}

Key receiver_table() {
  const std::vector<ReceiverKind> kinds = all_receiver_kinds();
  size_t flux_map = 0;
  while (kinds[flux_map].name != "flux_map") ++flux_map;
  return Key::tables("receiver",
                     {Key::choice_or("kind", choices_of(kinds), flux_map, "what is measured")},
                     "where light is measured");
}

Key joint_table() {
  return Key::tables("joint", joint_keys(), "a part of the scene that turns about an axis");
}

Key attitude_table() {
  return Key::table(
      "attitude",
      {Key::number_or("tilt_deg", 0.0, {0.0, pi},
                      "the body's z axis leans by the tilt towards the heading; with heading 0 it "
                      "turns about +y"),
       Key::number_or("heading_deg", 0.0, {-2.0 * pi, 2.0 * pi}, "from lab x towards y")},
      "how the platform stands");
}

Key trace_table() {
  const TraceOptions usual;
  return Key::table(
      "trace",
      {Key::integer_or(
           "rays", static_cast<int64_t>(usual.rays), 1, most_rays,
           "in total, rounded up per source and replicate to a power of two of at least "
           "256; at most 2^31 for each of the replicates. Gathered direct light takes "
           "none of them (see `direct`): its error goes down by `target_error` alone"),
       Key::integer_or("replicates", usual.replicates, 8, 1024,
                       "independent randomisations that the standard errors come from"),
       Key::integer_or("seed", static_cast<int64_t>(usual.seed), 0, INT64_MAX, "also `--seed`"),
       Key::integer_or("max_depth", usual.max_depth, 1, 65535, "interactions of a ray"),
       Key::number_or("cutoff", usual.cutoff, {0.0, 1.0, false, true},
                      "rays end below this fraction of their first power (this and `max_depth` are "
                      "reported as truncated power)"),
       Key::choice_or(
           "direct",
           {{"auto",
             "gathered, but with so many pairs of bin and lamp that it would take seconds and more "
             "than four times as long as the rays (thousands of lamps) by rays, which a note says; "
             "on bodies in sunlight alone"},
            {"gather",
             "direct light on flat flux maps, its torque on flat torque maps of plain surfaces, "
             "and "
             "its force and torque on bodies, from the surface's side, by quadrature where nothing "
             "can shade and shadow rays where something may"},
            {"rays", "by rays alone"}},
           0,
           "how direct light is found. Gathering takes sources with uniform apertures (`led`, "
           "`led_array`, `sun`, `ies` when round in aperture and beam); the others, and maps of "
           "curved surfaces, always go by rays"),
       Key::number("target_error", {1e-6, 1.0, false, false},
                   "go on with twice the rays until every bin above a tenth of its map's peak has "
                   "this relative standard error; also `--target-error`")
           .optional(),
       Key::number("max_time_s", Range::positive(),
                   "… or until the next round would end later than this; only with a target; also "
                   "`--max-time`")
           .optional(),
       Key::integer(
           "arriving_rays", 1, 10'000'000,
           "`trace` also writes, for every flux map, the rays that arrive there, of this "
           "many emitted ones (rounded up as `rays`, with 8 replicates): "
           "`rays_NAME.tm25ray`, IES TM-25, millimetres in the body frame, with power and, "
           "of line sources, wavelength; no file for a map that no ray meets; at most 4096 "
           "lamps")
           .optional()},
      "how much work the light is worth");
}

Key torque_map_table() {
  const auto step = [](const char* name, double range_rad, const char* what) {
    return Key::number(name, {0.0, range_rad, true, false}, what).optional();
  };
  return Key::table(
      "torque_map",
      {Key::numbers("tilt_deg", {0.0, pi}, "rising; every tilt with every heading")
           .usually_is("that of `[attitude]`"),
       Key::numbers("heading_deg", {-2.0 * pi, 2.0 * pi}, "rising")
           .usually_is("that of `[attitude]`"),
       Key::numbers("azimuth_deg", {-pi, pi},
                    "instead, for one `sun`: directions towards it in body axes, rising")
           .optional(),
       Key::numbers("elevation_deg", {-0.5 * pi, 0.5 * pi}, "with it, rising").optional(),
       step("azimuth_step_deg", 2.0 * pi,
            "or the whole sphere, which also writes `EXPERIMENT.spo` (SPAD, as GMAT reads it): a "
            "whole fraction of 360, at least 0.1"),
       step("elevation_step_deg", pi, "with it: a whole fraction of 180, at least 0.1"),
       Key::integer(
           "rays", 1, most_rays,
           "per attitude or direction. Plain surfaces in sunlight go by quadrature (unless "
           "`trace.direct` is \"rays\" or `trace.max_depth` below its default; `trace.cutoff` "
           "does not count there): 64 times as many, at most 2^24, for each of the two "
           "estimates of what they scatter")
           .usually_is("`trace.rays`")},
      "the attitudes, or directions of sunlight, of a table of forces and torques; without this "
      "table tilts of 0, 10, 20 and 30 deg towards eight headings");
}

Key camera_table() {
  const Camera usual;
  return Key::table(
      "camera",
      {Key::vector3("position_m", "lab axes, away from `target_m`")
           .usually_is("south-east of the scene, where `render` also sees the lamps"),
       Key::vector3_or("target_m", usual.target_m, "what is in the middle"),
       Key::number("field_of_view_deg", {0.0, pi, true, true}, "across the width")
           .usually_is("34.4"),
       Key::integer_or("width", usual.width, 16, 16384, "pixels"),
       Key::integer_or("height", usual.height, 16, 16384, "pixels"),
       Key::flag_or("lamps", usual.lamps, "lamps near the scene and some rays are drawn")},
      "where the picture of the scene is taken from");
}

}  // namespace

std::vector<Key> scene_tables() {
  return {scene_table(),    material_table(), source_table(),     receiver_table(), joint_table(),
          attitude_table(), trace_table(),    torque_map_table(), camera_table()};
}

}  // namespace photorque
