// Units in the names of keys.
#include "core/constants.h"
#include "core/settings/keys.h"
#include "core/settings/settings.h"

namespace photorque {
namespace {

struct Unit {
  const char* suffix;
  const char* dimension;
  double to_SI;
};

// The longest matching suffix counts ("_N_m" before "_m").
constexpr Unit units[] = {
    {"kg_m2", "inertia", 1.0},
    {"Wh_kg", "specific energy", 3600.0},
    {"J_kg", "specific energy", 1.0},
    {"S_m", "conductivity", 1.0},
    {"m_per_Ah", "shift per charge", 1.0 / 3600.0},
    {"kg_m3", "density", 1.0},
    {"N_m_s2", "drag by the square of the rate", 1.0},
    {"N_m_s_per_T2", "drag in a magnetic field", 1.0},
    {"N_m_s", "angular momentum", 1.0},
    {"N_m", "torque", 1.0},
    {"mN_m", "torque", 1e-3},
    {"uN_m", "torque", 1e-6},
    {"W_m2", "irradiance", 1.0},
    {"mW_cm2", "irradiance", 10.0},
    {"W_sr", "radiant intensity", 1.0},
    {"m_s2", "acceleration", 1.0},
    {"s2", "displacement per acceleration", 1.0},
    {"m_s", "speed", 1.0},
    {"cm_s", "speed", 1e-2},
    {"mm_s", "speed", 1e-3},
    {"km_h", "speed", 1.0 / 3.6},
    {"mph", "speed", 0.44704},
    {"rad_s", "angular rate", 1.0},
    {"mrad_s", "angular rate", 1e-3},
    {"deg_s", "angular rate", degree_rad},
    {"mdeg_s", "angular rate", 1e-3 * degree_rad},
    {"rpm", "angular rate", pi / 30},
    {"rev_s", "angular rate", 2.0 * pi},
    {"A_m2", "magnetic dipole", 1.0},
    {"A_W", "responsivity", 1.0},
    {"A_m2K3", "saturation", 1.0},
    {"V_K", "voltage per temperature", 1.0},
    {"W_K", "power per temperature", 1.0},
    {"deg", "angle", degree_rad},
    {"rad", "angle", 1.0},
    {"mrad", "angle", 1e-3},
    {"urad", "angle", 1e-6},
    {"mdeg", "angle", 1e-3 * degree_rad},
    {"rev", "angle", 2.0 * pi},
    {"arcmin", "angle", degree_rad / 60},
    {"arcsec", "angle", arcsecond_rad},
    {"km", "length", 1e3},
    {"mm", "length", 1e-3},
    {"um", "length", 1e-6},
    {"nm", "length", 1e-9},
    {"cm", "length", 1e-2},
    {"m", "length", 1.0},
    {"au", "length", astronomical_unit_m},
    {"m3", "area times length", 1.0},
    {"m2", "area", 1.0},
    {"cm2", "area", 1e-4},
    {"mm2", "area", 1e-6},
    {"kg_s", "drag", 1.0},
    {"kg_m", "drag by the square of the speed", 1.0},
    {"g_cm2", "inertia", 1e-7},
    {"g_cm", "mass times length", 1e-5},
    {"kg_mol", "molar mass", 1.0},
    {"g_mol", "molar mass", 1e-3},
    {"kg", "mass", 1.0},
    {"g", "mass", 1e-3},
    {"kW", "power", 1e3},
    {"mW", "power", 1e-3},
    {"W", "power", 1.0},
    {"Wh", "energy", 3600.0},
    {"J", "energy", 1.0},
    {"Ah", "charge", 3600.0},
    {"mAh", "charge", 3.6},
    {"C", "charge", 1.0},
    {"mA", "current", 1e-3},
    {"A", "current", 1.0},
    {"mV", "voltage", 1e-3},
    {"V", "voltage", 1.0},
    {"ohm", "resistance", 1.0},
    {"mohm", "resistance", 1e-3},
    {"K", "temperature", 1.0},
    {"Hz", "frequency", 1.0},
    {"kHz", "frequency", 1e3},
    {"MHz", "frequency", 1e6},
    {"GHz", "frequency", 1e9},
    {"ms", "time", 1e-3},
    {"us", "time", 1e-6},
    {"min", "time", 60.0},
    {"h", "time", 3600.0},
    {"s", "time", 1.0},
    {"Pa", "pressure", 1.0},
    {"bar", "pressure", 1e5},
    {"T", "magnetic field", 1.0},
    {"uT", "magnetic field", 1e-6},
    {"nT", "magnetic field", 1e-9},
    {"N", "force", 1.0},
};

bool ends_with_unit(std::string_view key, std::string_view suffix) {
  return key.size() > suffix.size() + 1 && key.ends_with(suffix) &&
         key[key.size() - suffix.size() - 1] == '_';
}

}  // namespace

KeyUnit unit_of_key(std::string_view key) {
  const Unit* best = nullptr;
  for (const Unit& unit : units) {
    const std::string_view suffix = unit.suffix;
    if (ends_with_unit(key, suffix) &&
        (best == nullptr || suffix.size() > std::string_view(best->suffix).size())) {
      best = &unit;
    }
  }
  if (best == nullptr) return {std::string(key), "", "", 1.0};
  const std::string_view suffix = best->suffix;
  std::string stem(key.substr(0, key.size() - suffix.size() - 1));
  // "stiffness_N_m_per_deg": one over the unit.
  if (stem.ends_with("_per")) {
    return {std::move(stem), best->suffix, std::string("per ") + best->dimension,
            1.0 / best->to_SI};
  }
  return {std::move(stem), best->suffix, best->dimension, best->to_SI};
}

std::vector<KeyUnit> units_of(const std::string& dimension) {
  constexpr std::string_view per = "per ";
  const bool inverse = dimension.starts_with(per);
  const std::string plain = inverse ? dimension.substr(per.size()) : dimension;
  std::vector<KeyUnit> all;
  for (const Unit& unit : units) {
    if (plain != unit.dimension) continue;
    all.push_back({"", unit.suffix, dimension, inverse ? 1.0 / unit.to_SI : unit.to_SI});
  }
  return all;
}

}  // namespace photorque
