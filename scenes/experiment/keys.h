// Keys of an experiment that this folder reads, and the tables of sources, receivers and materials.
#pragma once

#include <vector>

#include "core/constants.h"
#include "core/settings/typed_keys.h"

namespace photorque {

inline constexpr int64_t most_rays = int64_t{1} << 40;

namespace scene_key {
inline constexpr TextKey file("file",
                              "glTF or GLB, beside the experiment; metres, +Y up: glTF (x, y, z) "
                              "is body (x, −z, y). Or STL or OBJ, with `unit`");
inline constexpr ChoiceKey up("up", {"z", "y"}, 0,
                              "axis of an STL or OBJ file that points up at zero tilt; z: the axes "
                              "of the file are those of the body, y: as in glTF");
inline constexpr NumberKey metres_per_unit("metres_per_unit", 1.0, Range::positive(),
                                           "scale of the lengths of the file: 0.001 for a glTF "
                                           "model in millimetres, 0.1 for an STL or OBJ "
                                           "file in units of a CubeSat");
inline constexpr Vec3Key centre_of_rotation(
    "centre_of_rotation_m", {0.0, 0.0, 0.0},
    "position of the centre of rotation in the model, body axes (z up); it becomes the origin");
inline constexpr FlagKey textures(
    "textures", false,
    "true: materials that are derived from drawing values take their base colour from its picture "
    "(PNG, JPEG), as the mean over each triangle");
inline constexpr FlagKey allow_outside(
    "allow_outside", false,
    "true: links and paths of the model out of its folder are followed; also `--allow-outside`");
inline constexpr NumbersKey bands(
    "bands_nm", Range::not_negative(),
    "edges of 1 to 8 wavelength bands, rising; all light must fall inside",
    {.usually = "one band over all wavelengths"});
inline constexpr TableKey scene("scene", "the model that is lit");
}  // namespace scene_key

namespace attitude_key {
inline constexpr NumberKey tilt("tilt_deg", 0.0, {0.0, pi},
                                "angle of the body's z axis from the vertical, towards the "
                                "heading; with heading 0 the body rotates about +y");
inline constexpr NumberKey heading("heading_deg", 0.0, {-2.0 * pi, 2.0 * pi},
                                   "azimuth of the tilt direction, from lab x towards y");
inline constexpr TableKey attitude("attitude", "attitude of the platform");
}  // namespace attitude_key

namespace trace_key {
inline constexpr IntegerKey rays(
    "rays", 1, most_rays,
    "total number of rays, rounded up per source and replicate to a power of two of at least 256; "
    "at most 2^31 per replicate. Direct light by quadrature (see `direct`) uses no rays: only "
    "`target_error` reduces its error",
    {.optional = true});
inline constexpr IntegerKey replicates(
    "replicates", 8, 1024, "independent randomisations, from which the standard errors follow",
    {.optional = true});
inline constexpr IntegerKey seed("seed", 0, INT64_MAX, "seed of the random rays; also `--seed`",
                                 {.optional = true});
inline constexpr IntegerKey max_depth("max_depth", 1, 65535,
                                      "largest number of interactions of a ray",
                                      {.optional = true});
inline constexpr NumberKey cutoff("cutoff", {0.0, 1.0, false, true},
                                  "rays end below this fraction of their initial power (the power "
                                  "lost in this way and by `max_depth` is reported as truncated)",
                                  {.optional = true});
inline constexpr ChoiceKey direct(
    "direct",
    {{"auto",
      "quadrature for flux and torque maps, and for force and torque on bodies in sunlight; rays, "
      "with a note, if quadrature takes seconds and more than four times as long (thousands of "
      "lamps)"},
     {"gather",
      "quadrature over the lamps, with shadow rays for surfaces that may be shaded: for flat flux "
      "maps, flat torque maps of plain surfaces, and force and torque on bodies"},
     {"rays", "by rays alone"}},
    0,
    "method for direct light. Quadrature needs sources with uniform apertures (`led`, `led_array`, "
    "`sun`, `ies` if round in aperture and beam); other sources, and maps of curved surfaces, "
    "always use rays");
inline constexpr NumberKey target_error(
    "target_error", {1e-6, 1.0, false, false},
    "relative standard error of every bin above a tenth of the peak of its map; the rays are "
    "doubled until it is reached; also `--target-error`",
    {.optional = true});
inline constexpr NumberKey max_time("max_time_s", Range::positive(),
                                    "longest time of the trace, which ends before the next round "
                                    "would exceed it; only with `target_error`; also `--max-time`",
                                    {.optional = true});
inline constexpr IntegerKey arriving_rays(
    "arriving_rays", 1, 10'000'000,
    "number of emitted rays (rounded up as `rays`, with 8 replicates) from which `trace` writes "
    "those that arrive at each flux map: `rays_NAME.tm25ray` (IES TM-25, millimetres in the body "
    "frame, with power and, for line sources, wavelength), no file if no ray arrives; at most 4096 "
    "lamps",
    {.optional = true});
inline constexpr TableKey trace("trace", "accuracy and effort of the trace");
}  // namespace trace_key

namespace torque_map_key {
inline constexpr NumbersKey tilt(
    "tilt_deg", {0.0, pi}, "tilts in rising order; every tilt is combined with every heading",
    {.usually = "that of `[attitude]`; without the table 0, 10, 20, 30"});
inline constexpr NumbersKey heading(
    "heading_deg", {-2.0 * pi, 2.0 * pi}, "headings in rising order",
    {.usually = "that of `[attitude]`; without the table 0, 45, … 315"});
inline constexpr NumbersKey azimuth("azimuth_deg", {-pi, pi},
                                    "instead of tilts and headings, with one source of kind `sun`: "
                                    "azimuths of the Sun in body axes, in rising order",
                                    {.optional = true});
inline constexpr NumbersKey elevation(
    "elevation_deg", {-0.5 * pi, 0.5 * pi},
    "with `azimuth_deg`: elevations of the Sun in body axes, in rising order", {.optional = true});
inline constexpr NumberKey azimuth_step(
    "azimuth_step_deg", {0.0, 2.0 * pi, true, false},
    "*or* the step of the azimuth over the whole sphere, an integer fraction of 360, at least 0.1; "
    "also writes `EXPERIMENT.spo` (a SPAD file for GMAT)",
    {.optional = true});
inline constexpr NumberKey elevation_step(
    "elevation_step_deg", {0.0, pi, true, false},
    "step of the elevation, an integer fraction of 180, at least 0.1", {.optional = true});
inline constexpr IntegerKey rays(
    "rays", 1, most_rays,
    "number of rays per attitude or direction. Plain surfaces in sunlight are computed by "
    "quadrature, unless `trace.direct` is \"rays\" or `trace.max_depth` is below its default. Each "
    "of the two independent estimates of the scattered light then uses 64 times as many rays, at "
    "most 2^24; "
    "`trace.cutoff` has no effect on them",
    {.usually = "`trace.rays`"});
inline constexpr NumberKey flow_speed("speed_m_s", Range::positive(),
                                      "speed of the gas relative to the body");
inline constexpr NumberKey gas_temperature("temperature_K", Range::positive(),
                                           "temperature of the gas");
inline constexpr NumberKey molar_mass("molar_mass_kg_mol", Range::positive(),
                                      "mean molar mass of the gas (atomic oxygen: 0.016)");
inline constexpr NumberKey accommodation(
    "accommodation", 1.0, Range::fraction(),
    "fraction α of their excess energy that molecules leave at a surface");
inline constexpr NumberKey wall_temperature("wall_temperature_K", 300.0, Range::positive(),
                                            "temperature of the surfaces");
inline constexpr TextKey part_node("node", "a node of the scene, with the nodes below it");
inline constexpr TablesKey flow_part("part",
                                     "parts with other surfaces; later tables have precedence");
inline constexpr TableKey molecular_flow(
    "molecular_flow",
    "with azimuths and elevations, instead of sources: force and torque of a free-molecular gas "
    "that comes from these directions, per pascal of dynamic pressure");
inline constexpr TableKey torque_map(
    "torque_map",
    "the attitudes, or directions of sunlight, of a table of forces and torques; without this "
    "table tilts of 0, 10, 20 and 30 deg towards eight headings");
}  // namespace torque_map_key

namespace camera_key {
inline constexpr Vec3Key position(
    "position_m", "position of the camera, lab axes, different from `target_m`",
    {.usually = "south-east of the scene, at a distance at which the lamps are visible"});
inline constexpr Vec3Key target("target_m", {0.0, 0.0, 0.0}, "point in the middle of the picture");
inline constexpr NumberKey field_of_view("field_of_view_deg",
                                         {1e-3 * degree_rad, 179.0 * degree_rad},
                                         "field of view over the width of the picture",
                                         {.usually = "34.4"});
inline constexpr IntegerKey width("width", 16, 16384, "width of the picture in pixels",
                                  {.optional = true});
inline constexpr IntegerKey height("height", 16, 16384, "height of the picture in pixels",
                                   {.optional = true});
inline constexpr FlagKey lamps("lamps", true, "lamps near the scene and some rays are drawn");
inline constexpr TableKey camera("camera", "camera of the picture of the scene");
}  // namespace camera_key

// [scene], [[material]], [[source]], [[receiver]], [attitude], [trace], [torque_map], [camera].
std::vector<Key> scene_tables();

}  // namespace photorque
