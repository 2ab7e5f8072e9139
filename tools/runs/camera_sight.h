// What of the platform's model stands between the tracking camera and the markers.
#pragma once

#include "attitude/recordings/sensors.h"
#include "core/provenance.h"
#include "scenes/experiment/experiment.h"

namespace photorque {

// Where the experiment has a scene and a camera with geometry, lets the camera look through that
// scene: TrackingCamera::is_hidden by shadow rays. Returns names and hashes of the files read.
std::vector<std::pair<std::string, std::string>> look_through_scene(const ExperimentFile& file,
                                                                    Sensors& sensors);

}  // namespace photorque
