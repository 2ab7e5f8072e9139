// A platform of which nothing is known but its inertia, to be seen.
#pragma once

#include "attitude/model/platform.h"
#include "images/browser/stage.h"

namespace photorque {

// The even ellipsoid whose principal moments are in the platform's proportions, half as long as
// 1 m at its longest, and a rod along body x; camera and radius to match, and a remark that says
// so. A platform about one axis has one moment: a disc about that axis.
SceneStage platform_stage(const Platform& platform);

}  // namespace photorque
