// How each injected effect is drawn.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/proof/case.h"
#include "tools/proof/draw.h"

namespace photorque::injected {

struct Recipe {
  std::string kind;
  // The effect at a size that is plausible in a laboratory; the strength is then fitted to what the
  // readings shall show.
  std::function<InjectedEffect(RandomDraw&, const InjectedCase&)> draw;
  double most = 30.0;  // times that size at most
  bool needs_commands = false;
  bool needs_small_turns = false;
  bool pairs = false;  // may stand in a pair
  bool outside = false;
  std::string depends_on = {};
};

// One per kind of injected_kinds().
std::vector<Recipe> recipes();

}  // namespace photorque::injected
