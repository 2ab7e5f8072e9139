#include "photovoltaics/fit/rated_keys.h"

#include "core/text/parse.h"

namespace photorque {
namespace {

namespace rated_key {
constexpr Range cell_temperatures_K{coldest_cell_K, hottest_cell_K};
constexpr NumberKey irradiance("irradiance_W_m2", RatedPoint{}.irradiance_W_m2, Range::positive(),
                               "irradiance of the rated point");
constexpr NumberKey temperature("temperature_K", RatedPoint{}.temperature_K, cell_temperatures_K,
                                "temperature of the cells");
constexpr NumberKey short_circuit("short_circuit_A", Range::positive(), "current at 0 V");
constexpr NumberKey open_circuit("open_circuit_V", Range::positive(), "voltage at 0 A");
constexpr NumberKey maximum_current("maximum_A", Range::positive(), "current at the maximum power");
constexpr NumberKey maximum_voltage("maximum_V", Range::positive(), "voltage at the maximum power");
constexpr NumberKey short_circuit_slope(
    "short_circuit_slope_per_K", 5e-4, {},
    "temperature slope of the short-circuit current, as a fraction; with a datasheet");
constexpr NumberKey open_circuit_slope(
    "open_circuit_slope_per_K", -3e-3, {},
    "temperature slope of the open-circuit voltage, as a fraction; with a datasheet");
}  // namespace rated_key

}  // namespace

RatedPoint read_rated_point(const Settings& point) {
  using namespace rated_key;
  return {point.get(irradiance),   point.get(temperature),     point.get(short_circuit),
          point.get(open_circuit), point.get(maximum_current), point.get(maximum_voltage)};
}

std::vector<Key> rated_point_keys() {
  using namespace rated_key;
  return {irradiance, temperature, short_circuit, open_circuit, maximum_current, maximum_voltage};
}

TemperatureSlopes read_rated_slopes(const Settings& settings) {
  return {settings.get(rated_key::short_circuit_slope),
          settings.get(rated_key::open_circuit_slope)};
}

std::string assumed_slopes(const Settings& settings) {
  std::string keys;
  for (const NumberKey& key : {rated_key::open_circuit_slope, rated_key::short_circuit_slope}) {
    if (settings.has(key)) continue;
    keys +=
        (keys.empty() ? "" : ", ") + std::string(key.name) + " = " + shortest(settings.get(key));
  }
  return keys;
}

std::vector<Key> rated_slope_keys() {
  return {rated_key::short_circuit_slope, rated_key::open_circuit_slope};
}

}  // namespace photorque
