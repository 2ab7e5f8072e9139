// photorque supply: comparison of power supplies for the platform.
#include "tools/verbs/supply.h"

#include "attitude/propagation/run.h"
#include "tools/runs/attitude_run.h"
#include "tools/supply/trade.h"
#include "tools/verbs/verb.h"

namespace photorque {
namespace {

// All supplies, except that those by light are not traced yet.
struct SupplyInput {
  SupplyTrade trade;
  std::vector<BeamSettings> beams;
};

SupplyInput read_supply(const Settings& root, const RunOptions& options) {
  const Settings s = own_table(root, "supply_trade", true);
  SupplyInput read;
  SupplyTrade& trade = read.trade;
  trade.task = read_supply_task(root, s);
  const Settings battery = s.table_or_empty("battery");
  trade.options.push_back(battery_option(battery, trade.task));
  constexpr int steps = 20;
  for (int i = 0; i <= steps; ++i) {
    trade.charge_fraction.push_back(static_cast<double>(i) / steps);
    trade.battery_torque_N_m.push_back(
        battery_torque_N_m(battery, trade.task, trade.charge_fraction.back()));
  }
  trade.options.push_back(cable_option(s.table_or_empty("cable"), trade.task));
  for (const Settings& one : s.tables("microwave")) {
    trade.options.push_back(microwave_option(one, trade.task));
  }
  trade.options.push_back(induction_option(s.table_or_empty("induction"), trade.task));
  for (const Settings& one : s.tables("beam")) read.beams.push_back(read_beam(one, options));
  s.finish();
  return read;
}

}  // namespace

std::string supply_in_words(const RunOptions& options) {
  const SupplyInput read = read_supply(AttitudeExperiment(options).settings(), options);
  std::string words;
  for (const SupplyOption& option : read.trade.options) words += option.name + ", ";
  for (const BeamSettings& beam : read.beams) words += beam.name + ", ";
  return words + "for " + show(read.trade.task.load_W) + " W";
}

RunResult run_supply(const RunOptions& options, const Console& console) {
  const WallTime wall;
  const AttitudeExperiment experiment(options);
  auto [trade, beams] = read_supply(experiment.settings(), options);
  for (const BeamSettings& beam : beams) {
    trade.options.push_back(beam_option(beam, trade.task, console));
  }
  Product product = supply_product(trade);
  print_supply(console, product, trade);
  return {
      std::move(product), experiment.provenance(options.seed.value_or(0)), {wall.elapsed_s(), {}}};
}

}  // namespace photorque

namespace photorque::verbs::supply {

Verb kind() {
  return {"supply",
          "Comparison of power supplies (battery, cable, microwaves, induction, light): power, "
          "mass, torque",
          command_that_writes(experiment_options, run_supply),
          {"platform", "environment", "disturbance", "sensors", "supply_trade"},
          "[supply_trade]"};
}

}  // namespace photorque::verbs::supply
