// Headers that most files need and that seldom change; compiled once.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/constants.h"
#include "core/errors.h"
#include "core/settings/keys.h"
#include "core/settings/settings.h"
#include "core/settings/typed_keys.h"
#include "core/transform.h"
