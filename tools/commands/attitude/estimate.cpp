// photorque estimate: attitude and rate by Kalman filter and smoother.
#include "tools/tracking/estimate.h"

#include "core/errors.h"
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"

namespace photorque::kinds::estimate {
namespace {

std::string band_text(const Band& band) {
  return "95 % band " + show(band.low) + " to " + show(band.high);
}

void print_innovations(const Console& console, const std::string& name, const InnovationSum& sum) {
  if (!(sum.numbers > 0.0)) return;
  console.line("  NIS of " + padded(name, 9) + show(sum.per_number()) + " per number, of " +
               show(sum.numbers) + "; " + band_text(innovation_band(sum)));
}

void print_way(const Console& console, const EstimateRun::Estimated& one) {
  const Readings& readings = one.readings;
  const EstimateResult& result = one.result;
  console.heading(one.name + ": " + std::to_string(readings.rows) + " rows, " +
                  show(readings.last_s - readings.first_s) + " s" +
                  (readings.sees_attitude()
                       ? ", longest gap between attitudes " + show(readings.longest_gap_s) + " s"
                       : ""));
  if (!readings.unused.empty()) {
    std::string names;
    for (const std::string& name : readings.unused) names += " " + name;
    console.line("  columns not used:" + names);
  }
  for (const std::string& note : one.notes) console.line("  " + note);
  print_table(console, result.product.tables[0],
              {{"way", "way"},
               {"", "estimate"},
               {"rms error [\"]", "rms_error_arcsec"},
               {"predicted [\"]", "predicted_arcsec"},
               {"rms rate error [rad/s]", "rms_rate_error_rad_s"},
               {"NEES", "nees_per_number"},
               {"rows in 95 %", "rows_in_95_band"},
               {"NIS attitude", "nis_attitude"},
               {"NIS gyro", "nis_gyro"},
               {"rate walk", "rate_walk"}});
  const Ingredients& chosen = result.ways[result.chosen];
  console.heading("Written: " + chosen.name);
  print_innovations(console, "attitude", chosen.estimation.attitude);
  print_innovations(console, "gyro", chosen.estimation.gyro);
  print_innovations(console, "heading", chosen.estimation.heading);
  if (!chosen.estimation.parameter_names.empty()) {
    console.line();
    print_table(console, result.product.tables[1],
                {{"parameter", "parameter"},
                 {"seen", "seen"},
                 {"before", "before"},
                 {"sigma", "sigma_before"},
                 {"after", "after"},
                 {"sigma", "sigma_after"}});
  }
  if (!result.unseen.empty()) console.heading("What these readings cannot say");
  for (const std::string& line : result.unseen) console.line("  " + line);
}

void print_consistency(const Console& console, const ConsistencyResult& result) {
  const RunEnsemble& ensemble = result.ensemble;
  console.heading(std::to_string(ensemble.runs()) + " simulated runs");
  console.line("  mean NEES: " + band_text(ensemble.band()) + "; within it " +
               show_percent(result.part_filtered) + " of the rows filtered, " +
               show_percent(result.part_smoothed) + " smoothed (95 % expected)");
  print_innovations(console, "attitude", ensemble.attitude());
  print_innovations(console, "gyro", ensemble.gyro());
  console.line("  rms error of the smoother over that of the filter: at most " +
               show(result.worst_gain) + " at any row");
}

void run_estimate(const CommandLine& line) {
  const Console console = terminal(line);
  const EstimateRun run = estimate_of_experiment(line, console, line.recordings, line.truth);
  for (const EstimateRun::Estimated& one : run.estimated) print_way(console, one);
  if (run.consistency) print_consistency(console, *run.consistency);
  write_results(line, console, run.result);
}

}  // namespace

Verb kind() {
  Verb verb{"estimate", "Attitude and rate of recordings or simulated runs, filtered and smoothed",
            run_estimate};
  verb.takes_recordings = true;
  verb.takes_truth = true;
  return verb;
}

}  // namespace photorque::kinds::estimate
