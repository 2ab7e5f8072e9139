#include "tools/runs/array_power.h"

#include <algorithm>
#include <set>

#include "attitude/environment/environment.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "photovoltaics/array/incidence.h"
#include "photovoltaics/array/keys.h"

namespace photorque {

namespace {

// Power-weighted mean wavelength of the light in each band, from the ideal responsivity [A/W] with
// every photon converted.
std::vector<double> mean_wavelengths_m(const std::vector<double>& ideal_responsivity_A_W) {
  std::vector<double> wavelength_m;
  for (const double r : ideal_responsivity_A_W) {
    wavelength_m.push_back(r * planck_J_s * speed_of_light_m_s / elementary_charge_C);
  }
  return wavelength_m;
}

// Notices about bands in which the sources have different responsivities. Within a band only the
// total light of all sources is known.
std::vector<std::string> spectral_notices(const QuantumEfficiency& efficiency, const Bands& bands,
                                          const std::vector<WeighedSpectrum>& spectra) {
  constexpr double alike = 0.01;
  std::vector<std::string> notices;
  for (size_t b = 0; b < static_cast<size_t>(bands.count()); ++b) {
    double least = 1e300, most = 0.0;
    for (const WeighedSpectrum& one : spectra) {
      if (!(band_fractions(one.spectrum, bands)[b] > 1e-6)) continue;
      const double a = band_responsivity_A_W(efficiency, bands, std::span(&one, 1))[b];
      least = std::min(least, a);
      most = std::max(most, a);
    }
    if (!(most > (1.0 + alike) * least)) continue;
    notices.push_back("in band " + std::to_string(b + 1) + " the cells turn " + show(least) +
                      " to " + show(most) +
                      " A/W of the sources' light into current; the mean over what they emit is "
                      "taken for all, so give unlike sources separate bands ([scene] bands_nm)");
  }
  return notices;
}

// Sets the current per watt of the lamps' light in each band.
void read_responsivity(OpticalRun& run, ArrayPower& array) {
  const Experiment& experiment = run.experiment();
  std::vector<WeighedSpectrum> spectra;
  for (const Beam& beam : experiment.beams) {
    spectra.push_back({beam.spectrum, beam.emitter->power_W()});
  }
  const Bands& bands = experiment.scene.bands;
  const auto over_bands = [&](const QuantumEfficiency& efficiency) {
    const BandValues values = band_responsivity_A_W(efficiency, bands, spectra);
    return std::vector<double>(values.begin(), values.begin() + bands.count());
  };
  array.responsivity_A_W = over_bands(array.design.efficiency);
  array.notices = spectral_notices(array.design.efficiency, bands, spectra);
  for (std::string& line : light_outside(array.design.efficiency, spectra)) {
    run.warn(std::move(line));
  }
  array.ideal_responsivity_A_W = over_bands({{1e-8, 1e-4}, {1.0, 1.0}});
  std::set<std::string> spectra_in_words;
  for (const WeighedSpectrum& one : spectra) spectra_in_words.insert(in_words(one.spectrum));
  for (const std::string& words : spectra_in_words) {
    array.spectra += (array.spectra.empty() ? "" : ", ") + words;
  }
}

// Air from [environment]; none around a platform in orbit.
Surroundings surroundings_of(const ExperimentFile& file) {
  Surroundings around;
  for (const Settings& environment : file.others("environment")) {
    const Environment e = read_environment(environment);
    around = {e.air_temperature_K, e.air_pressure_Pa, e.air_pressure_Pa == 0.0};
  }
  for (const Settings& disturbance : file.others("disturbance")) {
    if (disturbance.text_or("kind", "") == "orbit") around.is_vacuum = true;
  }
  return around;
}

}  // namespace

ArrayPower read_array_power(OpticalRun& run, const ArrayPower* known) {
  const Experiment& experiment = run.experiment();
  const auto tables = experiment.file.others("array");
  if (tables.size() != 1) {
    throw InputError(
        {experiment.file.path.string()}, "array",
        tables.empty() ? "no table" : "more than one table",
        "one table [array]: receiver, cells and cell at least (photorque schema --key array)");
  }
  for (const NamedReceiver& receiver : experiment.receivers) {
    if (!receiver.flux_map || receiver.name != "cells") continue;
    throw InputError({experiment.file.path.string()}, "receiver.name", "\"cells\"",
                     "another name: power_on_cells_W is the light on the cells of the array");
  }
  ArrayPower array;
  array.flux_map = run.flux_map_index(tables[0].text_or("receiver", ""));
  const FluxMapReceiver& map = run.flux_map(array.flux_map);
  array.design =
      read_array_design(tables[0], read_cell_places(tables[0], experiment.scene, map.grid()));
  if (tables[0].has(array_key::back)) {
    const Settings back = tables[0].get(array_key::back);
    array.back_map = run.flux_map_index(back.get(array_key::back_receiver), "array.back.receiver");
    array.bifaciality = back.get(array_key::bifaciality);
  }
  const CellHeat heat = read_cell_heat(tables[0], surroundings_of(experiment.file));
  if (!tables[0].has(array_key::temperature)) array.design.heat = heat;
  array.report = read_array_report(tables[0], read_published(experiment.file.others("published")));
  tables[0].finish();

  if (known) {
    array.responsivity_A_W = known->responsivity_A_W;
    array.ideal_responsivity_A_W = known->ideal_responsivity_A_W;
    array.spectra = known->spectra;
  } else {
    read_responsivity(run, array);
  }
  if (array.design.front || has_own_front(experiment.scene, map.grid())) {
    const InputLocation where = tables[0].where();
    array.incidence =
        run.add_receiver({{std::make_shared<IncidenceReceiver>(
                              experiment.scene, map.grid(), array.design.front,
                              mean_wavelengths_m(array.ideal_responsivity_A_W), where)},
                          "incidence",
                          "incidence"});
  }
  return array;
}

ArrayLight light_on(const ArrayPower& array, const OpticalRun& run, std::span<const BinSums> sums) {
  ArrayLight light = array_light(run.flux_map(array.flux_map), sums[array.flux_map],
                                 array.incidence ? sums[*array.incidence] : BinSums{});
  if (array.back_map) {
    add_back_light(light, array_light(run.flux_map(*array.back_map), sums[*array.back_map]),
                   array.bifaciality);
  }
  return light;
}

ArrayResult evaluate(const ArrayPower& array, const OpticalRun& run, const TraceResult& result) {
  const ArrayLight light = light_on(array, run, result.sums);
  ArrayResult power = evaluate_array(array.design, light, array.responsivity_A_W);
  const double delivered = power.efficiency.value;
  const bool too_dark = array.design.heat && array.design.heat->absorptance < delivered;
  // An efficiency above 1 is an error of the cells, which is reported elsewhere.
  if (too_dark && delivered <= 1.0) {
    throw InputError({run.experiment().file.path.string()}, "array.thermal.absorptance",
                     show(array.design.heat->absorptance),
                     "at least what the cells deliver of the light on them, " + show(delivered));
  }
  return power;
}

std::string origin_of_temperature(const ArrayDesign& design) {
  return design.heat ? "steady state: " + design.heat->in_words() : "as stated";
}

std::string show_temperature(double kelvin) {
  return readable_number(kelvin, 4) + " K (" + readable_number(kelvin - 273.15, 3) + " °C)";
}

std::optional<std::string> above_rated(const ArrayDesign& design, double kelvin) {
  if (!(kelvin > design.rated_temperature_K)) return {};
  return "cells of " + show_temperature(kelvin) + " are above array.rated_temperature_K, " +
         show_temperature(design.rated_temperature_K) +
         ": less light, more cooling ([array.thermal]), or cells that are rated for it" +
         (kelvin >= hottest_cell_K
              ? "; no cells are computed at more than " + show(hottest_cell_K) + " K"
              : "");
}

Product array_power_product(const ArrayDesign& design, const ArrayResult& array,
                            const TraceResult& result) {
  Product product = array_product(array);
  product.quantities.push_back({"cell_temperature_is_stated", {design.heat ? 0.0 : 1.0, 0.0}});
  product.quantities.push_back({"cell_temperature_above_rated_K",
                                {array.temperature_K.value - design.rated_temperature_K,
                                 array.temperature_K.standard_error}});
  Table temperature = Table::of("cell_temperature", "The temperature of the cells");
  temperature.row()
      .set("origin", origin_of_temperature(design))
      .set("cell_temperature_K", array.temperature_K.value)
      .set("array_power_slope_W_K", array.power_per_K_W)
      .set("rated_temperature_K", design.rated_temperature_K);
  product.tables.push_back(std::move(temperature));
  const double emitted = result.power_balance.emitted_W;
  const auto over_emitted = [&](const Estimate& power) {
    return Estimate{power.value / emitted, power.standard_error / emitted};
  };
  product.quantities.push_back({"illumination_efficiency", over_emitted(array.power_on_cells_W)});
  product.quantities.push_back({"light_to_electric_efficiency", over_emitted(array.power_W)});
  return product;
}

std::optional<std::string> above_absorbed(const ArrayPower& array, const OpticalRun& run,
                                          const TraceResult& result, const ArrayResult& power) {
  double incident_W = 0.0, absorbed_W = 0.0;
  for (const std::optional<size_t> index : {std::optional(array.flux_map), array.back_map}) {
    if (!index) continue;
    const FluxMap map = run.flux_map(*index).flux_map(result.sums[*index]);
    incident_W += map.incident.power_W.value;
    absorbed_W += map.absorbed.power_W.value;
  }
  if (!(power.efficiency.value * incident_W > absorbed_W)) return {};
  return "the array delivers " + show_percent(power.efficiency.value) +
         " of the light on its cells, but their material absorbs only " +
         show_percent(absorbed_W / incident_W) +
         ": the quantum efficiency counts all light on the cells; state the cells' own absorptance "
         "in [[material]]";
}

void print_array(const Console& console, const ArrayPower& read, const ArrayResult& array,
                 const TraceResult& result) {
  const ArrayDesign& design = read.design;
  const double emitted = result.power_balance.emitted_W;
  console.heading("Solar array at its maximum power point, " + read.spectra);
  console.line("  light on the cells      " + show(array.power_on_cells_W, "W") + "  (" +
               show_percent(array.power_on_cells_W.value / emitted) + " of emitted)");
  const std::string slope =
      array.power_W.value > 0.0 ? ", " + show_brief(array.power_per_K_W) + " W/K" : "";
  console.line("  electric power          " + show(array.power_W, "W") + "  (" +
               show_percent(array.efficiency.value) + " of the light on the cells)" + slope);
  console.line("  voltage, current        " + show(array.voltage_V, "V") + ", " +
               show(array.current_A, "A"));
  console.line("  cell temperature        " + show_temperature(array.temperature_K.value) + ", " +
               origin_of_temperature(design));
  console.line("  sum of cell maxima      " + show(array.sum_of_cells_W, "W") + "  (" +
               show_percent(array.mismatch_loss.value) + " lost to uneven light and diodes)");
  if (array.mismatch_loss.value > 0.2) {
    console.line(
        "  note: the weakest cells limit the rest; bypass diodes (array.bypass_every) or another "
        "wiring (array.strings) give more");
  }
  const auto reversed = std::count_if(array.cells.voltages_V.begin(), array.cells.voltages_V.end(),
                                      [](double v) { return v < 0.0; });
  console.details().line("  local maxima of power   " + std::to_string(array.maxima.size()) +
                         "; cells in reverse at the best one: " + std::to_string(reversed));
}

}  // namespace photorque
