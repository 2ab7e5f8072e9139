// All that can be injected: the kinds of disturbance whose files say how, and the laws outside of
// the catalogue.
#pragma once

#include <string>
#include <vector>

#include "attitude/disturbances/screening.h"
#include "attitude/injection/injection.h"

namespace photorque::injected {

struct Recipe {
  std::string kind;
  Injection injection;
  Screening screening = {};                  // of a kind of disturbance
  std::string instrument = {};               // whose error it is
  bool outside = false;                      // of the catalogue
  std::vector<std::string> depends_on = {};  // of a law outside of it

  // Whether its readings change in proportion to its strength.
  bool is_proportional() const;
  size_t strengths() const;  // numbers of the strength
};

// The registry's kinds in its order, then the outside laws.
const std::vector<Recipe>& recipes();
// NumericalError for an unknown kind.
const Recipe& recipe_of(const std::string& kind);

// What the nominal model of every injected case has: their numbers stand in InjectedWorld and
// InjectedPriors, and files.cpp writes them into the experiment.
inline constexpr const char* nominal_unbalance = "static_unbalance";
inline constexpr const char* nominal_drag = "bearing_drag";
inline constexpr const char* nominal_gyro_bias = "gyro_bias";

}  // namespace photorque::injected
