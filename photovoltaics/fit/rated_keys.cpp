#include "photovoltaics/fit/rated_keys.h"

namespace photorque {

std::vector<Key> rated_point_keys() {
  const auto positive = [](const char* name, const char* what) {
    return Key::number(name, Range::positive(), what);
  };
  return {Key::number_or("irradiance_W_m2", 1000.0, Range::positive(), "of the light"),
          Key::number_or("temperature_K", 298.15, {1.0, 1000.0}, "of the cells"),
          positive("short_circuit_A", "current at 0 V"),
          positive("open_circuit_V", "voltage at 0 A"),
          positive("maximum_A", "current at the maximum power"),
          positive("maximum_V", "voltage there")};
}

std::vector<Key> rated_slope_keys() {
  return {Key::number_or("short_circuit_slope_per_K", 5e-4, {},
                         "of the short-circuit current, as a fraction; with a datasheet"),
          Key::number_or("open_circuit_slope_per_K", -3e-3, {},
                         "of the open-circuit voltage, as a fraction; with a datasheet")};
}

}  // namespace photorque
