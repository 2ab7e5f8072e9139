// photorque supply: comparison of power supplies for the platform.
#include "tools/verbs/supply.h"

#include "attitude/propagation/run.h"
#include "tools/runs/attitude_run.h"
#include "tools/supply/options.h"
#include "tools/supply/report.h"
#include "tools/verbs/verb.h"

namespace photorque {
namespace {

// All supplies except those by light, whose tables are returned.
struct TradeWithoutBeams {
  SupplyTrade trade;
  std::vector<Settings> beams;
};

TradeWithoutBeams read_trade(const Settings& root, const Settings& s) {
  TradeWithoutBeams read;
  read.beams = s.tables("beam");
  read.trade.task = read_supply_task(root, s);
  SupplyTrade& trade = read.trade;
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
  return read;
}

}  // namespace

std::string supply_in_words(const RunOptions& options) {
  const AttitudeExperiment experiment(options);
  const Settings s = own_table(experiment.settings(), "supply_trade", true);
  const TradeWithoutBeams read = read_trade(experiment.settings(), s);
  std::string words;
  for (const SupplyOption& option : read.trade.options) words += option.name + ", ";
  for (const Settings& beam : read.beams) words += read_beam(beam, options).name + ", ";
  s.finish();
  return words + "for " + show(read.trade.task.load_W) + " W";
}

RunResult run_supply(const RunOptions& options, const Console& console) {
  const WallTime wall;
  const AttitudeExperiment experiment(options);
  const Settings s = own_table(experiment.settings(), "supply_trade", true);
  TradeWithoutBeams read = read_trade(experiment.settings(), s);
  SupplyTrade trade = std::move(read.trade);
  std::vector<BeamSettings> beams;
  for (const Settings& beam : read.beams) beams.push_back(read_beam(beam, options));
  s.finish();
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
          command_that_writes(run_supply),
          {"platform", "environment", "disturbance", "sensors", "supply_trade"},
          "[supply_trade]"};
}

}  // namespace photorque::verbs::supply
