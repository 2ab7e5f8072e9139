#include "attitude/propagation/time_history.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "attitude/model/platform.h"
#include "core/constants.h"
#include "core/numerics/order.h"
#include "core/numerics/series.h"
#include "core/snapshot.h"

namespace photorque {
namespace {

// Largest value of each of up to 240 intervals, for a logarithmic axis: an oscillation through zero
// shows its amplitude. Intervals below `least` are gaps.
Plot::Curve envelope(const std::string& label, const std::vector<double>& x,
                     const std::vector<double>& size, double least) {
  constexpr size_t most = 240;
  const size_t intervals = std::min(most, x.size());
  Plot::Curve c;
  c.label = label;
  for (size_t s = 0; s < intervals; ++s) {
    const size_t begin = s * x.size() / intervals, end = (s + 1) * x.size() / intervals;
    const double largest = *std::max_element(size.begin() + static_cast<std::ptrdiff_t>(begin),
                                             size.begin() + static_cast<std::ptrdiff_t>(end));
    const bool shows = largest >= least && largest > 0.0;
    c.x.push_back(0.5 * (x[begin] + x[end - 1]));
    c.y.push_back(shows ? largest : std::numeric_limits<double>::quiet_NaN());
  }
  return c;
}

bool any_nonzero(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return v != 0.0; });
}

// Angles without jumps of 360°: 350°, 10° becomes 350°, 370°.
std::vector<double> unwrapped_deg(std::vector<double> angle_deg) {
  for (size_t i = 1; i < angle_deg.size(); ++i) {
    angle_deg[i] += 360.0 * std::round((angle_deg[i - 1] - angle_deg[i]) / 360.0);
  }
  return angle_deg;
}

// Stacked bars: mean fraction of each kind in each 120th of the run, in percent of the sum of all
// kinds, with the largest at the bottom. Kinds after the fifth are summed.
std::vector<Plot::Curve> stacked_fractions(const std::vector<double>& t,
                                           const std::vector<std::string>& labels,
                                           const std::vector<std::vector<double>>& sizes) {
  constexpr size_t most_parts = 120, most_named = 5;
  const size_t parts = std::min(most_parts, t.size()), kinds = sizes.size();
  std::vector<std::vector<double>> fractions(kinds, std::vector<double>(parts));
  std::vector<double> x(parts), of(kinds);
  for (size_t p = 0; p < parts; ++p) {
    const size_t begin = p * t.size() / parts, end = (p + 1) * t.size() / parts;
    x[p] =
        std::lerp(t.front(), t.back(), (static_cast<double>(p) + 0.5) / static_cast<double>(parts));
    double sum = 0.0;
    for (size_t k = 0; k < kinds; ++k) {
      for (size_t i = begin; i < end; ++i) fractions[k][p] += sizes[k][i];
      sum += fractions[k][p];
    }
    for (size_t k = 0; k < kinds; ++k) {
      fractions[k][p] *= sum > 0.0 ? 100.0 / sum : 0.0;
      of[k] += fractions[k][p];
    }
  }
  const std::vector<size_t> order =
      sorted_indices(kinds, [&](size_t a, size_t b) { return of[a] > of[b]; });
  std::vector<Plot::Curve> curves;
  std::vector<double> top(parts);
  for (size_t place = 0; place < kinds; ++place) {
    for (size_t p = 0; p < parts; ++p) top[p] += fractions[order[place]][p];
    const bool is_named = place < most_named;
    if (!is_named && place + 1 < kinds) continue;
    Plot::Curve curve;
    curve.label = is_named ? labels[order[place]] : std::to_string(kinds - most_named) + " others";
    if (!is_named) curve.colour = Plot::Colour::grey;
    curve.x = x;
    curve.y = top;
    curve.bars = true;
    curves.push_back(std::move(curve));
  }
  // The highest curve comes first, because each curve covers the lower part of the one before.
  std::ranges::reverse(curves);
  return curves;
}

const std::vector<double>& column_of(const Table& history, const std::string& column) {
  return history.column(column).values;
}

Plot over_time(const std::string& name, const std::string& title, const std::string& y,
               std::vector<Plot::Curve> curves) {
  return {name, title, "time [s]", y, std::move(curves)};
}

// Plot of the columns STEM_x_SUFFIX to STEM_z_SUFFIX. Oscillating curves of long runs would hide
// each other, so every axis has a separate panel.
Plot vector_plot(const Table& history, const std::string& name, const std::string& title,
                 const std::string& stem, const std::string& suffix, const std::string& unit) {
  const auto along = [&](const std::string& axis) {
    return thinned_curve(column_of(history, "t_s"), column_of(history, stem + axis + suffix));
  };
  Plot plot = over_time(name, title, "x [" + unit + "]", {along("_x_")});
  plot.below = {{"y [" + unit + "]", {along("_y_")}}, {"z [" + unit + "]", {along("_z_")}}};
  return plot;
}

// Plots of each torque, of their fractions and of their sizes, without torques that are zero.
void add_torque_plots(const Table& history, const std::vector<std::string>& labels,
                      std::vector<Plot>& plots) {
  std::vector<std::string> shown;
  std::vector<std::vector<double>> sizes;
  double largest_N_m = 0.0;
  for (const std::string& label : labels) {
    const std::string stem = "torque_" + label;
    std::vector<double> size = torque_sizes(history, stem);
    if (!any_nonzero(size)) continue;
    largest_N_m = std::max(largest_N_m, *std::max_element(size.begin(), size.end()));
    shown.push_back(label);
    sizes.push_back(std::move(size));
    plots.push_back(
        vector_plot(history, stem, "Torque of " + label + ", body axes", stem, "N_m", "N m"));
  }
  if (shown.empty()) return;
  // A torque below this fraction of the largest one cannot be seen in the motion.
  constexpr double min_fraction = 1e-9;
  const std::vector<double>& t = column_of(history, "t_s");
  std::vector<Plot::Curve> all;
  for (size_t i = 0; i < shown.size(); ++i) {
    all.push_back(envelope(shown[i], t, sizes[i], min_fraction * largest_N_m));
  }
  std::erase_if(all, [](const Plot::Curve& one) {
    return std::none_of(one.y.begin(), one.y.end(), [](double y) { return std::isfinite(y); });
  });
  plots.push_back(over_time("torque_fractions",
                            "Fraction of every torque in the sum of their sizes", "fraction [%]",
                            stacked_fractions(t, shown, sizes)));
  plots.push_back(over_time("torques", "Size of every torque, largest within each 240th of the run",
                            "torque [N m]", std::move(all)));
  plots.back().y_log = true;
}

}  // namespace

Excursion::Excursion(const PlatformState& initial)
    : until_s_(initial.time_s),
      largest_tilt_rad_(tilt_rad(initial)),
      largest_tilt_time_s_(initial.time_s),
      read_yaw_rad_(photorque::yaw_rad(initial)) {}

void Excursion::follow(const Propagator& motion) {
  constexpr int refinements = 3;  // each by a factor of four
  const double end_s = motion.step_end_s();
  if (!(end_s > until_s_)) return;
  std::vector<Lanes> y(static_cast<size_t>(motion.dynamics().size()));
  Lanes times_s;
  for (int i = 0; i < Lanes::count; ++i) {
    times_s.set(i, std::lerp(until_s_, end_s, (i + 1.0) / Lanes::count));
  }
  motion.dense(times_s, y.data());
  for (int i = 0; i < Lanes::count; ++i) {
    const double now_rad = photorque::yaw_rad(to_state(times_s[i], lane_of(y, i)));
    yaw_rad_ += std::remainder(now_rad - read_yaw_rad_, 2.0 * pi);
    read_yaw_rad_ = now_rad;
    least_yaw_rad_ = std::min(least_yaw_rad_, yaw_rad_);
    most_yaw_rad_ = std::max(most_yaw_rad_, yaw_rad_);
  }
  look(motion, until_s_, end_s, refinements);
  until_s_ = end_s;
}

void Excursion::look(const Propagator& motion, double from_s, double to_s, int refinements) {
  std::vector<Lanes> y(static_cast<size_t>(motion.dynamics().size()));
  Lanes times_s;
  for (int i = 0; i < Lanes::count; ++i) {
    times_s.set(i, std::lerp(from_s, to_s, i / (Lanes::count - 1.0)));
  }
  motion.dense(times_s, y.data());
  int highest = 0;
  double highest_rad = -1.0;
  for (int i = 0; i < Lanes::count; ++i) {
    const double tilt = tilt_rad(to_state(times_s[i], lane_of(y, i)));
    if (!(tilt > highest_rad)) continue;
    highest = i;
    highest_rad = tilt;
  }
  // Between two instants of a smooth motion the tilt rises little above both.
  constexpr double little = 1.1;
  if (!(little * highest_rad > largest_tilt_rad_)) return;
  if (highest_rad > largest_tilt_rad_) {
    largest_tilt_rad_ = highest_rad;
    largest_tilt_time_s_ = times_s[highest];
  }
  const bool is_inside = highest > 0 && highest + 1 < Lanes::count;
  if (refinements > 0 && is_inside) {
    look(motion, times_s[highest - 1], times_s[highest + 1], refinements - 1);
  }
}

void Excursion::keep(Snapshot& snapshot) {
  snapshot(until_s_, largest_tilt_rad_, largest_tilt_time_s_, read_yaw_rad_, yaw_rad_,
           least_yaw_rad_, most_yaw_rad_);
}

Plot::Curve thinned_curve(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr size_t most = 1600;
  Plot::Curve curve;
  for (const size_t i : lows_and_highs(y, most)) {
    curve.x.push_back(x[i]);
    curve.y.push_back(y[i]);
  }
  return curve;
}

Table event_table(const std::vector<Event>& events) {
  Table table = Table::of("events", "Events");
  for (const Event& event : events) {
    table.row().set("event", event.name).set("t_s", event.time_s);
  }
  return table;
}

std::vector<double> torque_sizes(const Table& history, const std::string& stem) {
  const auto along = [&](const char* end) -> const std::vector<double>& {
    return history.column(stem + end).values;
  };
  const std::vector<double>&x = along("_x_N_m"), &y = along("_y_N_m"), &z = along("_z_N_m");
  std::vector<double> sizes(x.size());
  for (size_t i = 0; i < x.size(); ++i) sizes[i] = std::hypot(x[i], y[i], z[i]);
  return sizes;
}

TimeHistory::TimeHistory(const Dynamics& dynamics)
    : table_(Table::of("time_history", "Attitude, rates, charge and torques",
                       {"t_s", "q_w", "q_x", "q_y", "q_z", "tilt_deg", "heading_deg", "yaw_deg",
                        "rate_x_rad_s", "rate_y_rad_s", "rate_z_rad_s", "charge_drawn_Ah",
                        "battery_current_A", "array_power_W"})) {
  const auto& disturbances = dynamics.model().disturbances;
  // The second disturbance of a kind gets the suffix _2, the third _3.
  std::vector<std::string> labels;
  for (const Disturbance& d : disturbances) {
    const auto same = std::count_if(
        disturbances.begin(), disturbances.begin() + static_cast<std::ptrdiff_t>(labels.size()),
        [&](const Disturbance& other) { return other.kind == d.kind; });
    labels.push_back(same == 0 ? d.kind : d.kind + "_" + std::to_string(same + 1));
  }
  for (size_t d = 0; d < disturbances.size(); ++d) {
    for (const ExtraState& state : disturbances[d].states) {
      table_.columns.push_back({labels[d] + "_" + state.name});
    }
  }
  for (size_t d = 0; d < disturbances.size(); ++d) {
    if (disturbances[d].stage == Stage::measurement) continue;
    acting_.push_back(d);
    labels_.push_back(labels[d]);
    for (const char axis : {'x', 'y', 'z'}) {
      table_.columns.push_back({"torque_" + labels[d] + "_" + axis + "_N_m"});
    }
  }
}

void TimeHistory::add(const PlatformState& state, const Dynamics::Instants& now, int lane) {
  size_t column = 0;
  const auto put = [&](double value) { table_.columns[column++].values.push_back(value); };
  const Quat& q = state.lab_from_body;
  put(state.time_s);
  for (const double x : {q.w(), q.x(), q.y(), q.z()}) put(x);
  put(tilt_rad(state) / degree_rad);
  put(heading_rad(state) / degree_rad);
  put(yaw_rad(state) / degree_rad);
  for (const double x : state.rate_body_rad_s) put(x);
  put(state.charge_drawn_C / 3600.0);
  put(now.battery_current_A[lane]);
  put(now.array_power_W[lane]);
  for (const double x : state.extra) put(x);
  for (const size_t d : acting_) {
    for (int k = 0; k < 3; ++k) put(now.torque_body_N_m[d][k][lane]);
  }
}

void TimeHistory::keep(Snapshot& snapshot) {
  std::vector<double>& times_s = table_.columns.front().values;
  snapshot.expect(table_.columns.size());
  snapshot(times_s);
  for (Table::Column& column : table_.columns) {
    column.values.resize(times_s.size());
    snapshot.fixed(column.values);
  }
}

Product TimeHistory::product(const Excursion& excursion, const std::vector<Event>& events,
                             const Propagator::Statistics& statistics) const {
  Product product;
  product.tables.push_back(table_);
  if (!events.empty()) product.tables.push_back(event_table(events));
  const std::vector<double>&t = column_of(table_, "t_s"), &yaw_deg = column_of(table_, "yaw_deg"),
        &tilt_deg = column_of(table_, "tilt_deg"),
        &charge_Ah = column_of(table_, "charge_drawn_Ah"),
        &power_W = column_of(table_, "array_power_W");
  std::vector<Plot>& plots = product.plots;
  plots.push_back(over_time("tilt", "Tilt", "tilt [deg]", {thinned_curve(t, tilt_deg)}));
  plots.push_back(over_time("yaw", "Yaw", "yaw [deg]", {thinned_curve(t, unwrapped_deg(yaw_deg))}));
  plots.push_back(vector_plot(table_, "rates", "Body rates", "rate", "rad_s", "rad/s"));
  if (any_nonzero(charge_Ah)) {
    plots.push_back(over_time("charge", "Charge missing from the battery", "charge [Ah]",
                              {thinned_curve(t, charge_Ah)}));
  }
  if (any_nonzero(power_W)) {
    plots.push_back(over_time("array_power", "Power of the solar array", "power [W]",
                              {thinned_curve(t, power_W)}));
  }
  add_torque_plots(table_, labels_, plots);

  if (!t.empty()) {
    const auto last = [&](const std::string& column) { return column_of(table_, column).back(); };
    product.quantities = {
        {"final_time_s", {t.back()}},
        {"final_tilt_deg", {tilt_deg.back()}},
        {"largest_tilt_deg", {excursion.largest_tilt_rad() / degree_rad}},
        {"largest_tilt_time_s", {excursion.largest_tilt_time_s()}},
        {"yaw_excursion_deg", {excursion.yaw_rad() / degree_rad}},
        {"final_heading_deg", {last("heading_deg")}},
        {"final_yaw_deg", {yaw_deg.back()}},
        {"final_rate_rad_s",
         {std::hypot(last("rate_x_rad_s"), last("rate_y_rad_s"), last("rate_z_rad_s"))}},
        {"final_charge_drawn_Ah", {charge_Ah.back()}},
    };
  }
  product.quantities.push_back({"steps", {static_cast<double>(statistics.steps)}});
  return product;
}

}  // namespace photorque
