#include "photovoltaics/array/keys.h"

#include "photovoltaics/array/design.h"

namespace photorque {
namespace {

std::vector<Key> diode_keys(double drop_V) {
  using namespace diode_key;
  return {drop.with_default(drop_V), saturation, ideality, series};
}

// Keys that replace the `usual` values of the cells.
std::vector<Key> cell_keys(std::string_view usual) {
  using namespace cell_key;
  std::vector<Key> keys;
  for (const NumberKey& key : {saturation_1, saturation_2, ideality_1, ideality_2, series, shunt,
                               shunt_photocurrent, shunt_dark, shunt_exponent, breakdown_fraction,
                               breakdown, breakdown_exponent, gap, gap_slope, photocurrent_slope}) {
    keys.push_back(key.usually(usual));
  }
  return keys;
}

std::vector<Key> all_cells_keys() {
  using namespace cell_key;
  constexpr std::string_view usual = "that of `cell`";
  return joined(
      {{reference_area.usually(usual), reference_temperature.usually(usual)}, cell_keys(usual)});
}

std::vector<Key> one_cell_keys() {
  using namespace cell_key;
  constexpr std::string_view usual = "that of the others";
  return joined({{index, cell_key::photocurrent_factor,
                  reference_area.usually(usual).meaning(
                      "area to which the currents and resistances of this table refer; required "
                      "with them if the area of the other cells is not stated")},
                 cell_keys(usual)});
}

std::vector<Key> wiring_keys() {
  using namespace array_key;
  return {series,
          strings,
          bypass_every,
          cross_tied,
          circuit,
          wiring,
          bypass,
          blocking,
          bypass_diode.of(diode_keys(bypass_drop_V)),
          blocking_diode.of(diode_keys(0.0))};
}

std::vector<Key> place_keys() {
  using namespace array_key;
  return {cells, rectangle.of({low, high}), gap, margin};
}

}  // namespace

std::vector<Key> array_design_keys() {
  using namespace array_key;
  std::vector<Key::Choice> kinds;
  for (const NamedCell& cell : known_cells()) kinds.push_back({cell.name, cell.summary});
  return joined({place_keys(),
                 wiring_keys(),
                 {temperature, rated_temperature, thermal.of(thermal_keys()),
                  Key::choice_or("cell", std::move(kinds), 1, "type of the cells"),
                  cell_parameters.of(all_cells_keys()), cell_override.of(one_cell_keys()),
                  quantum_efficiency_peak, quantum_efficiency.of({wavelength, efficiency}),
                  back.of({back_receiver, bifaciality}), cover.of(cell_front_keys())}});
}

}  // namespace photorque
