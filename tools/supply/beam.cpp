// Power by light: an experiment with lamps and array, traced at every tilt.
#include <filesystem>

#include "tools/runs/array_power.h"
#include "tools/runs/optical_run.h"
#include "tools/supply/trade.h"

namespace photorque {
namespace {

namespace beam_key {
constexpr TextKey name("name", "name of the supply");
constexpr TextKey experiment(
    "experiment", "experiment file in the same folder, with `[scene]`, sources and `[array]`");
constexpr NumberKey lamp_efficiency("lamp_efficiency", 0.5, conversion_range,
                                    "radiant power of the lamps divided by mains power");
constexpr NumberKey converter_efficiency("converter_efficiency", 0.97, conversion_range,
                                         "efficiency of the converter after the array");
constexpr NumberKey array_mass("array_mass_kg", 0.25, Range::not_negative(), "mass of the array");
constexpr IntegerKey rays("rays", 256, int64_t{1} << 40, "number of rays of the trace",
                          {.usually = "those of that experiment"});
constexpr TablesKey beam("beam", "light on a solar array");
}  // namespace beam_key

RunOptions options_of_beam(const Settings& s, const RunOptions& options) {
  const std::string name = s.get(beam_key::experiment);
  RunOptions beam;
  beam.experiment = options.experiment.parent_path() / name;
  if (!std::filesystem::is_regular_file(beam.experiment)) {
    throw s.error(beam_key::experiment, "\"" + name + "\"", "an experiment beside this one");
  }
  beam.threads = options.threads;
  beam.seed = options.seed;
  beam.max_memory_GB = options.max_memory_GB;
  if (s.has(beam_key::rays)) {
    beam.overrides.push_back("trace.rays=" + std::to_string(s.get(beam_key::rays)));
  }
  return beam;
}

Estimate times(const Estimate& x, double factor) {
  return {factor * x.value, factor * x.standard_error};
}

Estimate ratio(const Estimate& a, double b) {
  return times(a, 1.0 / b);
}

}  // namespace

BeamSettings read_beam(const Settings& s, const RunOptions& options) {
  BeamSettings beam;
  beam.name = s.get(beam_key::name);
  beam.experiment = s.get(beam_key::experiment);
  beam.run = options_of_beam(s, options);
  beam.lamp_efficiency = s.get(beam_key::lamp_efficiency);
  beam.converter_efficiency = s.get(beam_key::converter_efficiency);
  beam.array_mass_kg = s.get(beam_key::array_mass);
  return beam;
}

SupplyOption beam_option(const BeamSettings& beam, const SupplyTask& task, const Console& console) {
  OpticalRun run(beam.run, Console());
  const ArrayPower array = read_array_power(run);
  SupplyOption option;
  option.name = option.symbol = beam.name;
  for (char& c : option.symbol) c = c == ' ' || c == '-' || c == '.' ? '_' : c;
  option.mass_kg = {beam.array_mass_kg, 0.0};
  const auto progress = console.progress("tracing " + beam.name);
  for (size_t t = 0; t < task.tilt_rad.size(); ++t) {
    const OpticalResult light = run.run(lab_from_body_at(task.tilt_rad[t], 0.0), {});
    const ArrayResult power = evaluate(array, run, light);
    const WrenchEstimate wrench = run.wrench_of(light);
    option.curve.push_back({times(power.power_W, beam.converter_efficiency),
                            {wrench.mean.torque_N_m.y(), wrench.torque_error_N_m().y()},
                            {}});
    const double emitted_W = light.power_balance.emitted_W;
    if (t == 0) {
      option.remarks = {"as traced: " + beam.experiment + "; cells at " +
                        show_temperature(power.temperature_K.value) + ", " +
                        origin_of_temperature(array.design)};
      if (auto warning = above_rated(array.design, power.temperature_K.value)) {
        option.remarks.push_back(std::move(*warning));
      }
      option.source_W = {emitted_W / beam.lamp_efficiency, 0.0};
      option.figures = {{"emitted_W", {emitted_W, 0.0}},
                        {"light_on_cells_fraction", ratio(power.power_on_cells_W, emitted_W)},
                        {"conversion_fraction", power.efficiency},
                        {"cell_temperature_K", power.temperature_K},
                        {"array_W", power.power_W}};
    }
    if (t + 1 == task.tilt_rad.size()) {
      option.figures.emplace_back("sum_of_cells_tilted_W", power.sum_of_cells_W);
      option.figures.emplace_back("array_tilted_W", power.power_W);
    }
    if (progress) progress(static_cast<double>(t + 1) / static_cast<double>(task.tilt_rad.size()));
  }
  console.done();
  return option;
}

Key beam_table() {
  using namespace beam_key;
  return beam.of({name, experiment, lamp_efficiency, converter_efficiency, array_mass, rays});
}

}  // namespace photorque
