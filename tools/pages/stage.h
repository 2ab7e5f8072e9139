// The scene of an optical run as the stage of a page.
#pragma once

#include "images/browser/stage.h"
#include "tools/runs/optical_run.h"

namespace photorque {

// A grey that shows how much a surface reflects; the eye takes reflectance in powers.
Rgb reflectance_grey(const OpticalSurface& surface);

// Parts, lamps and camera, and the surfaces of all flux maps, in one painting of their irradiance,
// and of torque maps, one for each axis; no states yet. With `maps` = "own" their maps come with
// add_light(); otherwise the surfaces name those of OpticalRun::product().
enum class StageMaps { of_product, own };
SceneStage stage_of(const OpticalRun& run, StageMaps maps);

// Force and torque of the light at an attitude, about the centre of rotation.
StageState lit_state(const OpticalRun& run, const RigidTransform& lab_from_body,
                     const OpticalResult& result);

// One of `lights` that the stage will have: rays and, for surfaces with maps of their own, the
// irradiance; the more lights, the fewer rays and bins.
void add_light(SceneStage& stage, const OpticalRun& run, const RigidTransform& lab_from_body,
               const OpticalResult& result, size_t lights);

// The light at up to 12 of some attitudes of the body, evenly over them; each of them shows the
// nearest, and the stage's remark says so.
void light_along(SceneStage& stage, const OpticalRun& run, const std::vector<Quat>& lab_from_body);

// The surface of a receiver's bins, to be painted with maps that the caller gives.
PaintedSurface painted_receiver(const OpticalRun& run, const std::string& receiver);

}  // namespace photorque
