// The torque laws of the injected motion, one function each.
#pragma once

#include <string>
#include <vector>

#include "tools/proof/motion.h"
#include "tools/proof/vectors.h"

namespace photorque::injected {

// What a law may look at. Vectors in body axes.
struct Surroundings {
  double time_s = 0.0;
  Quaternion attitude = {1, 0, 0, 0};
  Triple rate = {};
  double charge_Ah = 0.0;
  double mass_kg = 0.0;
  Triple offset_m = {};
  Matrix inertia = {};
  Triple gravity = {}, field = {}, up = {};
  Triple gravity_level = {};  // in body axes at zero attitude
  double gravity_m_s2 = 0.0;
  Triple command_N_m = {};
};

// The numbers of an effect in the order that its law wants them.
using Numbers = std::vector<double>;
using TorqueFunction = Triple (*)(const Numbers&, const Surroundings&);

struct LawEntry {
  std::string kind;
  std::vector<std::string> keys;  // in that order, arrays laid out one after the other
  TorqueFunction torque;          // null: acts elsewhere (instruments, inertia, gravity)
  bool in_catalogue = true;
};

const std::vector<LawEntry>& laws();
// NumericalError for an unknown kind.
const LawEntry& law_of(const std::string& kind);
Numbers numbers_of(const InjectedEffect& effect);

}  // namespace photorque::injected
