#include "attitude/studies/balance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "attitude/estimation/fit.h"
#include "attitude/estimation/segments.h"
#include "attitude/observation/noise_levels.h"
#include "attitude/propagation/run.h"
#include "core/errors.h"
#include "core/text/format.h"

namespace photorque {
namespace {

// The resolution of the centre of mass in the paper, section II.A.1.
constexpr double published_resolution_m = 1.79e-7;

// Index of the model's static unbalance. Adds one with zero offset if there is none.
size_t unbalance_of(AttitudeModel& model) {
  for (size_t d = 0; d < model.disturbances.size(); ++d) {
    if (model.disturbances[d].kind == "static_unbalance") return d;
  }
  model.disturbances.push_back(make_disturbance_of(
      "static_unbalance", {{"offset_m", {0.0, 0.0, 0.0}}}, {model.platform, model.environment}));
  return model.disturbances.size() - 1;
}

// Free parameters: the offset without a prior, and all parameters with a stated uncertainty.
Hypothesis hypothesis_of(const BalanceRun& run, const AttitudeModel& model, size_t unbalance,
                         const std::vector<Observation>& seen) {
  Hypothesis h = nominal_hypothesis({model, run.sensors}, seen);
  std::erase_if(h.free, [&](const Free& f) { return f.disturbance == unbalance; });
  for (int k = 0; k < 3; ++k) h.free.push_back({unbalance, k});
  return h;
}

// Growing windows: a poor start is improved before a long run can diverge from it.
FitSettings convergent_settings() {
  FitSettings settings;
  settings.windows = {0.02, 0.07, 0.25, 1.0};
  settings.max_iterations = 30;
  // A hundredth of a standard error.
  settings.min_gain = 1e-4;
  settings.min_gain_fraction = 0.0;
  settings.tolerance = 1e-8;
  return settings;
}

// Residuals of the camera's attitudes.
void add_camera_residuals(const std::vector<Observation>& segments, BalanceResult& result) {
  const std::vector<Prediction> predicted = residuals_of(result.fit, segments);
  for (size_t s = 0; s < segments.size(); ++s) {
    const Observation& seen = segments[s];
    for (size_t i = 0; i < seen.blocks(); ++i) {
      if (!(seen.attitude_rows[i] > 0.0)) continue;
      result.residual_time_s.push_back(seen.time_s[i]);
      result.camera_residual_rad.emplace_back(predicted[s].off[i].head<3>());
    }
  }
}

// The segments of the recording between gaps, each with a separate initial state.
std::vector<Observation> segments_of(const BalanceRun& run) {
  std::vector<Observation> all =
      observe_segments(run.recording, "recording", run.model.platform, run.recording.rows()).all;
  for (Observation& seen : all) seen.noise = noise_levels(run.sensors);
  return all;
}

Vec3 offset_of(const Fit& fitted, size_t unbalance) {
  Vec3 offset_m = Vec3::Zero();
  for (const Free& f : fitted.best.free) {
    if (f.disturbance == unbalance) offset_m[f.parameter] = fitted.best.parameter(f).value;
  }
  return offset_m;
}

// The largest difference, per axis, between the offset fitted to parts of the recording and that of
// the whole: a measure of the systematic error due to effects that the model lacks.
Vec3 distance_of_parts_m(const BalanceRun& run, const Fit& whole, size_t unbalance,
                         const std::vector<Observation>& segments) {
  constexpr size_t parts = 6, fewest_blocks = 60;
  const Vec3 offset_m = offset_of(whole, unbalance);
  Vec3 largest_m = Vec3::Zero();
  bool has_any = false;
  for (const Observation& seen : segments) {
    const size_t length = std::max(fewest_blocks, seen.blocks() / parts);
    for (size_t first = 0; first + length <= seen.blocks(); first += length) {
      const std::vector<Observation> part = {seen.part(first, first + length)};
      const Hypothesis start = hypothesis_of(run, whole.best.model, unbalance, part);
      const Fit fitted = fit(start, part, convergent_settings());
      if (!std::isfinite(fitted.chi2)) continue;
      largest_m = largest_m.cwiseMax((offset_of(fitted, unbalance) - offset_m).cwiseAbs());
      has_any = true;
    }
  }
  return has_any ? largest_m : Vec3::Constant(INFINITY);
}

// A second fit, in which the residual of the first counts as noise.
Fit fit_with_discrepancy(const Fit& fitted, std::vector<Observation> segments) {
  const NoiseLevels noise = with_discrepancy(residuals_of(fitted, segments), segments,
                                             segments.front().noise, Remainder::correlated);
  for (Observation& seen : segments) seen.noise = noise;
  return fit(fitted.best, segments, convergent_settings());
}

// Attitude and rate of the rows that have both. The rate is that of the gyro, or the mean rate
// between attitudes half an interval before and after.
struct Row {
  double time_s;
  Quat lab_from_body;
  Vec3 rate_rad_s;
  Vec3 command_N_m;
};

class Rows {
 public:
  explicit Rows(const Recording& recording) : recording_(recording) {
    for (size_t k = 0; k < 4; ++k) {
      channels_[k] = recording.find(quaternion_names[k]);
      if (channels_[k] != nullptr) continue;
      throw InputError({}, "recording", "no channel " + std::string(quaternion_names[k]),
                       "attitudes");
    }
    for (size_t k = 0; k < 3; ++k) channels_[4 + k] = recording.find(gyro_names[k]);
  }

  std::vector<Row> all(double interval_s) const {
    const Schedule schedule = recording_.schedule();
    std::vector<Row> rows;
    for (size_t i = 0; i < recording_.rows(); ++i) {
      const double t_s = recording_.time_s[i];
      const Quat q = attitude(i);
      const Vec3 rate = rate_at(i, interval_s);
      const bool is_attitude = q.norm() > 0.0 && std::isfinite(q.norm());
      if (!is_attitude || !rate.allFinite()) continue;
      if (rate.cwiseAbs().maxCoeff() > fastest_rad_s) {
        throw InputError({}, "recording", "a rate of " + readable_number(rate.norm(), 3) + " rad/s",
                         "rates below 1e6 rad/s");
      }
      rows.push_back({t_s, q.normalized(), rate, schedule.at(t_s).command_body_N_m});
    }
    return rows;
  }

 private:
  static constexpr double fastest_rad_s = 1e6;  // no platform withstands this

  double value(size_t channel, size_t row) const { return channels_[channel]->values[row]; }
  Quat attitude(size_t row) const {
    return {value(0, row), value(1, row), value(2, row), value(3, row)};
  }

  Vec3 rate_at(size_t row, double interval_s) const {
    if (channels_[4] && channels_[5] && channels_[6]) {
      return {value(4, row), value(5, row), value(6, row)};
    }
    const std::vector<double>& t = recording_.time_s;
    const auto nearest = [&](double time_s) {
      return static_cast<size_t>(std::lower_bound(t.begin(), t.end(), time_s) - t.begin());
    };
    const size_t before = nearest(t[row] - 0.5 * interval_s);
    const size_t after = nearest(t[row] + 0.5 * interval_s);
    if (after >= t.size() || after <= before || t[after] - t[before] > 2.0 * interval_s) {
      return Vec3::Constant(NAN);
    }
    return turn_vector(attitude(before).conjugate() * attitude(after)) / (t[after] - t[before]);
  }

  const Recording& recording_;
  std::array<const Channel*, 7> channels_{};
};

}  // namespace

Vec3 offset_from_momentum_m(const Platform& platform, const Vec3& gravity_lab_m_s2,
                            const Recording& recording, double interval_s) {
  const std::vector<Row> rows = Rows(recording).all(interval_s);
  const Mat3& inertia = platform.inertia_kg_m2;
  // Unknowns: the offset and a drag coefficient, so that drag is not attributed to the offset.
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  int intervals = 0;
  for (size_t first = 0; first + 1 < rows.size();) {
    Vec3 gravity = Vec3::Zero(), gyroscopic = Vec3::Zero(), angle = Vec3::Zero();
    Vec3 command = Vec3::Zero();
    size_t last = first;
    for (; last + 1 < rows.size() && rows[last].time_s - rows[first].time_s < interval_s; ++last) {
      const Row &a = rows[last], &b = rows[last + 1];
      const double half_s = 0.5 * (b.time_s - a.time_s);
      const auto in_body = [&](const Row& row) {
        return Vec3(row.lab_from_body.conjugate() * gravity_lab_m_s2);
      };
      gravity += half_s * (in_body(a) + in_body(b));
      gyroscopic += half_s * (a.rate_rad_s.cross(inertia * a.rate_rad_s) +
                              b.rate_rad_s.cross(inertia * b.rate_rad_s));
      angle += half_s * (a.rate_rad_s + b.rate_rad_s);
      command += 2.0 * half_s * a.command_N_m;
    }
    const double length_s = rows[last].time_s - rows[first].time_s;
    if (length_s < 2.0 * interval_s && last > first) {
      const Vec3 known =
          inertia * (rows[last].rate_rad_s - rows[first].rate_rad_s) + gyroscopic - command;
      Eigen::Matrix<double, 3, 4> slope;
      slope << -platform.mass_kg * skew(gravity), -angle;
      matrix += slope.transpose() * slope;
      right += slope.transpose() * known;
      ++intervals;
    }
    first = std::max(last, first + 1);
  }
  if (intervals < 3) {
    throw InputError({}, "recording",
                     std::to_string(rows.size()) + " rows with an attitude and a rate, of " +
                         std::to_string(recording.rows()) + ": " + std::to_string(intervals) +
                         " intervals without a gap",
                     "at least three");
  }
  // An offset along gravity has no torque. For a platform that stays level, its estimate is zero.
  const double smallest = 1e-12 * matrix.topLeftCorner<3, 3>().trace();
  matrix.diagonal().array() += smallest;
  const Eigen::Vector4d solution = matrix.ldlt().solve(right);
  return solution.head<3>();
}

BalanceRun read_balance(const Settings& root, const std::filesystem::path& recording) {
  NominalModel nominal = read_attitude_model(root);
  const Settings columns = own_table(root, "recording", false);
  const Settings masses = own_table(root, "balance", true);
  BalanceRun run{std::move(nominal.model), std::move(nominal.sensors), read_moving_masses(masses),
                 read_recording(recording, read_recording_options(columns))};
  refuse_absent_columns(columns, {&run.recording});
  for (const Settings& settings : {columns, masses}) settings.finish();
  run.model.schedule = run.recording.schedule();
  return run;
}

BalanceResult balance(const BalanceRun& run) {
  AttitudeModel model = run.model;
  const size_t unbalance = unbalance_of(model);
  const Vec3 guess_m =
      offset_from_momentum_m(model.platform, model.environment.gravity_lab_m_s2, run.recording);
  std::vector<Parameter>& offset = model.disturbances[unbalance].parameters;
  for (size_t k = 0; k < 3; ++k) offset[k].value = guess_m[static_cast<Eigen::Index>(k)];

  const std::vector<Observation> segments = segments_of(run);
  BalanceResult result;
  result.segments = segments.size();
  result.fit = fit(hypothesis_of(run, model, unbalance, segments), segments, convergent_settings());
  if (!std::isfinite(result.fit.chi2)) {
    throw NumericalError("the model cannot be propagated along the recording");
  }
  result.chi2_per_sample = result.fit.chi2_per_sample();
  result.excess_sigma =
      (result.chi2_per_sample - 1.0) * std::sqrt(0.5 * static_cast<double>(result.fit.samples));
  if (result.exceeds_noise()) {
    const Fit beside = fit_with_discrepancy(result.fit, segments);
    if (std::isfinite(beside.chi2)) result.fit = beside;
  }
  const Vec3 distance_m = result.exceeds_noise()
                              ? distance_of_parts_m(run, result.fit, unbalance, segments)
                              : Vec3(Vec3::Zero());
  add_camera_residuals(segments, result);

  result.offset_body_m = offset_of(result.fit, unbalance);
  const inference::Covariance known = result.fit.shared();
  Eigen::Index shared = 0;
  for (const Free& f : result.fit.best.free) {
    if (f.per_run) continue;
    if (f.disturbance == unbalance) {
      result.sigma_m[f.parameter] =
          std::hypot(known.standard_error(shared), distance_m[f.parameter]);
    }
    ++shared;
  }
  const double mass_kg = model.platform.mass_kg;
  result.command = balancing_steps(result.offset_body_m, run.masses, mass_kg);
  for (const MovingMass& mass : run.masses) {
    result.resolution_m = std::max(result.resolution_m, com_resolution_m(mass, mass_kg));
  }
  return result;
}

std::string BalanceResult::warning() const {
  if (!exceeds_noise()) return "";
  return "the experiment lacks an effect: the residual of the fit is " +
         readable_number(std::sqrt(chi2_per_sample), 3) +
         " times the noise; the errors include the scatter between parts of the recording, but no "
         "common bias (photorque diagnose finds the effect)";
}

Product balance_product(const BalanceRun& run, const BalanceResult& result) {
  const auto components = [](const Vec3& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  Product product;
  Table axes = Table::of("balance", "Centre of mass from the centre of rotation, body axes");
  axes.add("axis", std::vector<std::string>{"x", "y", "z"})
      .add("offset_m", components(result.offset_body_m))
      .add("sigma_m", components(result.sigma_m))
      .add("left_by_steps_m", components(result.command.left_over_m))
      .add("published_resolution_m", components(Vec3::Constant(published_resolution_m)));
  product.tables.push_back(axes);

  Table masses = Table::of("moving_masses", "Moves of the balancing masses");
  for (size_t i = 0; i < run.masses.size(); ++i) {
    const MovingMass& mass = run.masses[i];
    const double steps = static_cast<double>(result.command.steps[i]);
    masses.row()
        .set("mass", std::to_string(i + 1))
        .set("direction_x", mass.direction_body.x())
        .set("direction_y", mass.direction_body.y())
        .set("direction_z", mass.direction_body.z())
        .set("steps", steps)
        .set("travel_m", steps * mass.pitch_m());
  }
  product.tables.push_back(masses);

  const double weight_N =
      run.model.platform.mass_kg * run.model.environment.gravity_lab_m_s2.norm();
  const double left_m = result.command.left_over_m.norm();
  const auto exact = [&](const std::string& name, double value) {
    product.quantities.push_back({name, {value, 0.0}});
  };
  for (int k = 0; k < 3; ++k) {
    product.quantities.push_back(
        {std::string("offset_") + "xyz"[k] + "_m", {result.offset_body_m[k], result.sigma_m[k]}});
  }
  exact("left_by_steps_m", left_m);
  exact("left_by_steps_N_m", left_m * weight_N);
  exact("resolution_m", result.resolution_m);
  exact("published_resolution_m", published_resolution_m);
  exact("chi2_per_sample", result.chi2_per_sample);

  Plot plot{"balance_residuals", "Camera minus fitted trajectory, about lab axes", "time [s]",
            "about x [arcsec]"};
  // More points would hide each other.
  constexpr size_t max_points = 2000;
  const size_t rows = result.residual_time_s.size();
  const size_t every = rows / max_points + 1;
  if (every > 1) plot.title += ", one row in " + std::to_string(every);
  const auto residuals = [&](int axis) {
    Plot::Curve curve;
    curve.markers = true;
    for (size_t i = 0; i < rows; i += every) {
      curve.x.push_back(result.residual_time_s[i]);
      curve.y.push_back(result.camera_residual_rad[i][axis] / arcsecond_rad);
    }
    return curve;
  };
  plot.curves = {residuals(0)};
  plot.below = {{"about y [arcsec]", {residuals(1)}}, {"about z [arcsec]", {residuals(2)}}};
  product.plots.push_back(std::move(plot));
  return product;
}

Key balance_table() {
  return Key::table("balance", moving_mass_keys(), "the masses that balance the platform");
}

}  // namespace photorque
