// How many cases of each family `prove` makes: the keys of [prove] that say so.
#pragma once

#include "core/settings/settings.h"
#include "tools/proof/case.h"

namespace photorque {

InjectedPlan read_plan(const Settings& prove);

}  // namespace photorque
