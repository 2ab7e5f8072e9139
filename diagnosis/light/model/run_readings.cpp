// Readings of a recording whose light is known: currents and voltages of the array, residuals, and
// their derivatives with respect to the light.
#include <algorithm>
#include <cmath>

#include "diagnosis/light/model/run.h"

namespace photorque {
std::vector<double> LightRun::photocurrents(const std::vector<double>& signals, size_t row) const {
  const auto first = signals.begin() + static_cast<std::ptrdiff_t>(first_output_[row]);
  return {first, first + static_cast<std::ptrdiff_t>(lab_->cells().size())};
}

ArrayCurve LightRun::curve(const LightState& state, const std::vector<double>& signals,
                           size_t row) const {
  const ArrayDesign& design = lab_->design();
  const double temperature_K = recording_.temperature_K[row];
  ArrayChanges changes;
  changes.series_ohm = state.series_ohm;
  changes.cell_offset_V =
      state.voltage_V_per_K * (temperature_K - design.cell.reference.temperature_K);
  changes.string_open = state.string_open;
  changes.bypass_shorted = state.bypass_shorted;
  return {design.wiring, cells_at(temperature_K, state.shunt_S), photocurrents(signals, row),
          changes};
}

CellTables LightRun::cells_at(double temperature_K, double leak_S) const {
  const auto known = cells_at_.find(temperature_K);
  if (leak_S == 0.0 && known != cells_at_.end()) return known->second;
  return lab_->cell_laws(temperature_K, leak_S, false);
}

bool LightRun::is_trapped(const LightState& state, size_t row) const {
  return std::ranges::any_of(state.trapped, [&](const LightState::Interval& i) {
    return i.recording == number_ && recording_.time_s[row] >= i.from_s &&
           recording_.time_s[row] <= i.to_s;
  });
}

double LightRun::chi2_at(const ArrayPoint& maximum, size_t row) const {
  const double v = (recording_.voltage_V[row] - maximum.voltage_V) / lab_->noise().voltage_V,
               i = (recording_.current_A[row] - maximum.current_A) / lab_->noise().current_A;
  return v * v + i * i;
}

// The highest maximum or, if the tracker is trapped, the one nearest to the reading. (Near its
// appearance a maximum may exist in the modelled light but not in the true light, or vice versa.
// Corners and the highest maximum are therefore included.)
std::optional<LightRun::Held> LightRun::held_maximum(const ArrayCurve& curve, bool is_trapped,
                                                     size_t row) const {
  if (!is_trapped) {
    const ArrayPoint highest = curve.maximum_power();
    if (!(highest.power_W() > 0.0)) return std::nullopt;
    return Held{highest, highest, false, true, false};
  }
  const ArrayCurve::Scan scan = curve.scan(1);
  const auto by_power = [](const ArrayPoint& p) { return p.power_W(); };
  const auto highest = std::ranges::max_element(scan.maxima, {}, by_power);
  if (highest == scan.maxima.end()) return std::nullopt;
  const bool has_others = scan.maxima.size() + scan.corners.size() > 1;
  Held held{*highest, *highest, false, true, has_others};
  const auto consider = [&](const std::vector<ArrayPoint>& points, bool are_corners) {
    for (const ArrayPoint& p : points) {
      if (chi2_at(p, row) < chi2_at(held.at, row)) held = {p, *highest, are_corners, false, true};
    }
  };
  consider(scan.maxima, false);
  consider(scan.corners, true);
  return held;
}

double LightRun::current_law(const LightState& state, size_t row, double voltage_V) const {
  if (state.current_laws.empty()) return 0.0;
  SampleConditions c = circumstances_[first_output_[row]];
  c.voltage = voltage_V / voltage_scale_V_;
  double sum = 0.0;
  for (const auto& law : state.current_laws) sum += law(c);
  return sum * current_scale_A_;
}

Eigen::VectorXd LightRun::residuals(const LightState& state, const std::vector<double>& signals,
                                    SignalSlopes* slopes) const {
  Eigen::VectorXd r(static_cast<Eigen::Index>(samples()));
  if (is_scan()) {
    if (slopes != nullptr) slopes->of_scan.resize(samples());
    for (size_t i = 0; i < samples(); ++i) {
      r[static_cast<Eigen::Index>(i)] =
          (recording_.irradiance_W_m2[i] - signals[i]) / irradiance_sigma_[i];
      if (slopes != nullptr) slopes->of_scan[i] = -1.0 / irradiance_sigma_[i];
    }
    return r;
  }
  const auto cells = static_cast<Eigen::Index>(lab_->cells().size());
  if (slopes != nullptr) slopes->by_photocurrent.setZero(r.size(), cells);
  const double sigma_V = lab_->noise().voltage_V, sigma_A = lab_->noise().current_A;
  std::optional<ArrayCurve> curve_of_row;
  std::vector<ArrayPoint> trace;
  size_t known = static_cast<size_t>(-1);
  Eigen::Index at = 0;
  for (size_t row = 0; row < rows(); ++row) {
    if (first_output_[row] != known) {
      curve_of_row.emplace(curve(state, signals, row));
      known = first_output_[row];
      if (!is_run()) trace = curve_of_row->trace();
    }
    const double law_A = current_law(state, row, recording_.voltage_V[row]);
    const double V = recording_.voltage_V[row], I = recording_.current_A[row] - law_A;
    if (!holds_maximum()) {
      const ArrayCurve::SlopedPoint p = curve_of_row->nearest({V, I}, {sigma_V, sigma_A}, trace);
      const double across = std::hypot(sigma_A, p.slope_S * sigma_V);
      const double off_V = (V - p.voltage_V) / sigma_V, off_A = (I - p.current_A) / sigma_A;
      const double side = (I - p.current_A) + p.slope_S * (V - p.voltage_V);
      r[at] = std::copysign(std::hypot(off_V, off_A), side);
      if (slopes != nullptr) {
        const std::vector<double> moved =
            curve_of_row->current_by_photocurrent({p.voltage_V, p.current_A});
        slopes->by_photocurrent.row(at) =
            Eigen::Map<const Eigen::RowVectorXd>(moved.data(), cells) / -across;
      }
      ++at;
      continue;
    }
    const std::optional<Held> held = held_maximum(*curve_of_row, is_trapped(state, row), row);
    const ArrayPoint m = held ? held->at : ArrayPoint{};
    r[at] = (V - m.voltage_V) / sigma_V;
    r[at + 1] = (I - m.current_A) / sigma_A;
    if (slopes != nullptr && held && !held->is_corner) {
      const ArrayCurve::MaximumMotion moved = curve_of_row->maximum_by_photocurrent(m);
      slopes->by_photocurrent.row(at) =
          Eigen::Map<const Eigen::RowVectorXd>(moved.voltage_ohm.data(), cells) / -sigma_V;
      slopes->by_photocurrent.row(at + 1) =
          Eigen::Map<const Eigen::RowVectorXd>(moved.current.data(), cells) / -sigma_A;
    }
    at += 2;
  }
  return r;
}

Eigen::VectorXd LightRun::moved(const SignalSlopes& slopes,
                                const std::vector<double>& change) const {
  Eigen::VectorXd result(static_cast<Eigen::Index>(samples()));
  if (is_scan()) {
    for (size_t i = 0; i < samples(); ++i) {
      result[static_cast<Eigen::Index>(i)] = slopes.of_scan[i] * change[i];
    }
    return result;
  }
  const size_t cells = lab_->cells().size();
  for (size_t i = 0; i < samples(); ++i) {
    double sum = 0.0;
    const size_t first = first_output_[sample_row_[i]];
    for (size_t k = 0; k < cells; ++k) {
      sum += slopes.by_photocurrent(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) *
             change[first + k];
    }
    result[static_cast<Eigen::Index>(i)] = sum;
  }
  return result;
}

std::vector<double> LightRun::gain_if_trapped(const LightState& state,
                                              const std::vector<double>& signals) const {
  std::vector<double> gain(rows(), 0.0);
  if (!holds_maximum()) return gain;
  // Penalty for a reading at the highest maximum: only few of them may be within a trapped
  // interval.
  constexpr double loss = 10.0;
  for (size_t row = 0; row < rows(); ++row) {
    const ArrayCurve array = curve(state, signals, row);
    const std::optional<Held> held = held_maximum(array, true, row);
    if (!held || !held->has_others) continue;
    gain[row] = held->is_highest ? -loss : chi2_at(held->highest, row) - chi2_at(held->at, row);
  }
  return gain;
}

std::vector<LightRun::Expected> LightRun::expected(const LightState& state) const {
  const std::vector<double> signal = signals(state, fields(state, nullptr));
  std::vector<Expected> result(rows());
  for (size_t row = 0; row < rows(); ++row) {
    Expected& e = result[row];
    if (is_scan()) {
      e.irradiance_W_m2 = signal[row];
      continue;
    }
    const ArrayCurve at = curve(state, signal, row);
    if (!holds_maximum()) {
      // The current at the measured voltage: nearest() with a huge error of the current.
      constexpr double far = 1e6;
      const auto p = at.nearest({recording_.voltage_V[row], recording_.current_A[row]},
                                {lab_->noise().voltage_V, far * lab_->noise().current_A});
      e.voltage_V = recording_.voltage_V[row];
      e.current_A = p.current_A + current_law(state, row, e.voltage_V);
      continue;
    }
    const std::optional<Held> held = held_maximum(at, is_trapped(state, row), row);
    if (!held) continue;
    e.voltage_V = held->at.voltage_V;
    e.current_A = held->at.current_A + current_law(state, row, held->at.voltage_V);
  }
  return result;
}

}  // namespace photorque
