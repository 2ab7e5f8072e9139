#include "attitude/filtering/report.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constants.h"

namespace photorque {
namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double in_arcsec(double rad) {
  return rad / arcsecond_rad;
}

double rms_sigma_rad(const std::vector<AttitudeEstimate>& estimates) {
  double sum = 0.0;
  for (const AttitudeEstimate& e : estimates) sum += std::pow(e.attitude_sigma_rad(), 2);
  return std::sqrt(sum / static_cast<double>(std::max<size_t>(1, estimates.size())));
}

size_t settled_row(size_t rows) {
  return rows / 20;
}

Table methods_table(const std::vector<Ingredients>& methods, const TruthTrack& truth) {
  Table table = Table::of("ingredients", "Contribution of each instrument and model");
  for (const Ingredients& method : methods) {
    const Estimation& e = method.estimation;
    for (const bool smooth : {false, true}) {
      // Without attitude readings, the smoother equals the filter.
      if (smooth && !method.settings.uses_attitude &&
          method.settings.motion == Motion::gyro_drives) {
        continue;
      }
      const auto& estimates = smooth ? e.smoothed : e.filtered;
      RunErrors errors{not_known, not_known, not_known, not_known, 0};
      if (!truth.empty()) errors = run_errors(estimates, truth, settled_row(estimates.size()));
      table.row()
          .set("way", method.name)
          .set("estimate", smooth ? "smoother" : "filter")
          .set("rms_error_arcsec", in_arcsec(errors.rms_attitude_rad))
          .set("predicted_arcsec", in_arcsec(rms_sigma_rad(estimates)))
          .set("rms_rate_error_rad_s", errors.rms_rate_rad_s)
          .set("nees_per_number", errors.mean_nees)
          .set("rows_in_95_band", errors.part_in_band)
          .set("nis_attitude", e.attitude.numbers > 0 ? e.attitude.per_number() : not_known)
          .set("nis_gyro", e.gyro.numbers > 0 ? e.gyro.per_number() : not_known)
          .set("rate_walk", method.settings.rate_walk_rad_s_rts);
    }
  }
  return table;
}

size_t thinning(size_t rows) {
  constexpr size_t points = 2000;
  return std::max<size_t>(1, rows / points);
}

namespace {

// Root-mean-square error in each block of rows.
Plot::Curve error_curve(const std::string& label, const std::vector<AttitudeEstimate>& estimates,
                        const TruthTrack& truth) {
  Plot::Curve curve{label};
  constexpr size_t intervals = 240;
  const size_t step = std::max<size_t>(1, estimates.size() / intervals);
  for (size_t i = 0; i < estimates.size(); i += step) {
    double sum = 0.0;
    size_t count = 0;
    const size_t end = std::min(estimates.size(), i + step);
    for (size_t k = i; k < end; ++k) {
      if (!truth.empty() && !truth[k]) continue;
      const double error_rad = truth.empty() ? estimates[k].attitude_sigma_rad()
                                             : attitude_error_rad(estimates[k], *truth[k]);
      sum += error_rad * error_rad;
      ++count;
    }
    if (count == 0) continue;
    curve.x.push_back(0.5 * (estimates[i].time_s + estimates[end - 1].time_s));
    curve.y.push_back(in_arcsec(std::sqrt(sum / static_cast<double>(count))));
  }
  return curve;
}

}  // namespace

Plot methods_plot(const std::vector<Ingredients>& methods, const TruthTrack& truth) {
  const std::string what = truth.empty() ? "predicted attitude error" : "attitude error";
  Plot plot{"attitude_errors", "Contribution of each instrument and model", "time [s]",
            "filter: " + what + " [arcsec]"};
  plot.y_log = true;
  Plot::Panel below{"smoother [arcsec]", {}, true};
  for (const Ingredients& method : methods) {
    plot.curves.push_back(error_curve(method.name, method.estimation.filtered, truth));
    below.curves.push_back(error_curve(method.name, method.estimation.smoothed, truth));
  }
  plot.below.push_back(below);
  return plot;
}

Table parameter_table(const Estimation& e) {
  Table table = Table::of("parameters", "Parameters estimated from the readings (SI)",
                          {"parameter", "seen", "before", "sigma_before", "after", "sigma_after"});
  for (size_t i = 0; i < e.parameter_names.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double ratio = e.sigma[at] / e.prior_sigma[at];
    const char* seen = ratio < 0.3 ? "yes" : ratio < 0.8 ? "in part" : "no";
    table.row()
        .set("parameter", e.parameter_names[i])
        .set("seen", seen)
        .set("before", e.prior_mean[at])
        .set("sigma_before", e.prior_sigma[at])
        .set("after", e.parameters[at])
        .set("sigma_after", e.sigma[at]);
  }
  return table;
}

Table estimate_table(const Estimation& e) {
  const std::vector<std::string> quantities = {"q_w",          "q_x",          "q_y",
                                               "q_z",          "rate_x_rad_s", "rate_y_rad_s",
                                               "rate_z_rad_s", "sigma_rad",    "rate_sigma_rad_s"};
  Table table = Table::of("estimate", "Attitude and rate, filtered and smoothed");
  const size_t step = thinning(e.filtered.size());
  std::vector<double> times;
  for (size_t i = 0; i < e.filtered.size(); i += step) times.push_back(e.filtered[i].time_s);
  table.add("t_s", times);
  for (const auto* estimates : {&e.filtered, &e.smoothed}) {
    std::vector<std::vector<double>> columns(quantities.size());
    for (size_t i = 0; i < estimates->size(); i += step) {
      const AttitudeEstimate& one = (*estimates)[i];
      const Quat& q = one.lab_from_body;
      const Vec3& w = one.rate_body_rad_s;
      const double row[] = {q.w(),
                            q.x(),
                            q.y(),
                            q.z(),
                            w.x(),
                            w.y(),
                            w.z(),
                            one.attitude_sigma_rad(),
                            one.rate_sigma_rad_s()};
      for (size_t k = 0; k < columns.size(); ++k) columns[k].push_back(row[k]);
    }
    const std::string stem = estimates == &e.filtered ? "filtered_" : "smoothed_";
    for (size_t k = 0; k < columns.size(); ++k) table.add(stem + quantities[k], columns[k]);
  }
  return table;
}

}  // namespace photorque
