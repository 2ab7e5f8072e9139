// What a recording reads where its light is known: currents and voltages of the array, what is left
// of the readings, and how both move with the light.
#include <algorithm>
#include <cmath>

#include "diagnosis/light/model/run.h"

namespace photorque {
namespace {

// Of the maxima, highest first, the one at which the tracker stands: the highest, or, where it is
// trapped, the one from which the reading is least far. (One that the light has just taken away or
// brought up may stand in the model's light and not in the true one, or the other way round: a
// corner counts, and so does the highest.) `chi2` is that of a maximum.
template <class Chi2>
size_t held_maximum(const std::vector<LitNetwork::Maximum>& maxima, bool is_trapped,
                    const Chi2& chi2) {
  size_t nearest = 0;
  for (size_t i = 1; is_trapped && i < maxima.size(); ++i) {
    if (chi2(maxima[i]) < chi2(maxima[nearest])) nearest = i;
  }
  return nearest;
}

}  // namespace

std::vector<double> LightRun::photocurrents(const std::vector<double>& signals, size_t row) const {
  const auto first = signals.begin() + static_cast<std::ptrdiff_t>(first_output_[row]);
  return {first, first + static_cast<std::ptrdiff_t>(lab_->cells().size())};
}

LitNetwork LightRun::network(const LightState& state, const std::vector<double>& signals,
                             size_t row) const {
  const ArrayDesign& design = lab_->design();
  NetworkSettings settings;
  const double temperature_K = recording_.temperature_K[row];
  settings.series_ohm = state.series_ohm;
  settings.cell_offset_V =
      state.voltage_V_per_K * (temperature_K - design.cell.reference.temperature_K);
  settings.string_open = state.string_open;
  settings.bypass_shorted = state.bypass_shorted;
  return {design.wiring, cells_at(temperature_K, state.shunt_S), settings,
          photocurrents(signals, row)};
}

std::shared_ptr<const LitCells> LightRun::cells_at(double temperature_K, double shunt_S) const {
  const auto known = cells_at_.find(temperature_K);
  if (shunt_S == 0.0 && known != cells_at_.end()) return known->second;
  return std::make_shared<const LitCells>(lab_->lit(temperature_K, shunt_S, false));
}

bool LightRun::is_trapped(const LightState& state, size_t row) const {
  return std::ranges::any_of(state.trapped, [&](const LightState::Interval& i) {
    return i.recording == number_ && recording_.time_s[row] >= i.from_s &&
           recording_.time_s[row] <= i.to_s;
  });
}

std::function<double(const LitNetwork::Maximum&)> LightRun::off(size_t row) const {
  const double sigma_V = noise_factor_ * lab_->noise().voltage_V,
               sigma_A = noise_factor_ * lab_->noise().current_A;
  return [=, V = recording_.voltage_V[row],
          I = recording_.current_A[row]](const LitNetwork::Maximum& m) {
    const double v = (V - m.voltage_V) / sigma_V, i = (I - m.current_A) / sigma_A;
    return v * v + i * i;
  };
}

double LightRun::current_law(const LightState& state, size_t row, double voltage_V) const {
  if (state.current_laws.empty()) return 0.0;
  Circumstance c = circumstances_[first_output_[row]];
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
  const double sigma_V = noise_factor_ * lab_->noise().voltage_V,
               sigma_A = noise_factor_ * lab_->noise().current_A;
  std::optional<LitNetwork> network_of_row;
  LitNetwork::Trace trace;
  size_t known = static_cast<size_t>(-1);
  Eigen::Index at = 0;
  for (size_t row = 0; row < rows(); ++row) {
    if (first_output_[row] != known) {
      network_of_row.emplace(network(state, signals, row));
      known = first_output_[row];
      if (!is_run()) trace = network_of_row->trace();
    }
    const double law_A = current_law(state, row, recording_.voltage_V[row]);
    const double V = recording_.voltage_V[row], I = recording_.current_A[row] - law_A;
    if (!holds_maximum()) {
      const LitNetwork::Point p =
          network_of_row->nearest(V, I, sigma_V, sigma_A, slopes != nullptr, trace);
      const double across = std::hypot(sigma_A, p.slope_S * sigma_V);
      const double off_V = (V - p.voltage_V) / sigma_V, off_A = (I - p.current_A) / sigma_A;
      const double side = (I - p.current_A) + p.slope_S * (V - p.voltage_V);
      r[at] = std::copysign(std::hypot(off_V, off_A), side);
      for (Eigen::Index k = 0; slopes != nullptr && k < cells; ++k) {
        slopes->by_photocurrent(at, k) =
            -p.current_by_photocurrent[static_cast<size_t>(k)] / across;
      }
      ++at;
      continue;
    }
    const bool trapped = is_trapped(state, row);
    const std::vector<LitNetwork::Maximum> maxima = network_of_row->maxima(
        trapped ? LitNetwork::Which::with_corners : LitNetwork::Which::highest, slopes != nullptr);
    const bool dark = maxima.empty();
    const LitNetwork::Maximum none;
    const LitNetwork::Maximum& m = dark ? none : maxima[held_maximum(maxima, trapped, off(row))];
    r[at] = (V - m.voltage_V) / sigma_V;
    r[at + 1] = (I - m.current_A) / sigma_A;
    for (Eigen::Index k = 0; slopes != nullptr && !dark && k < cells; ++k) {
      const auto c = static_cast<size_t>(k);
      slopes->by_photocurrent(at, k) = -m.voltage_by_photocurrent[c] / sigma_V;
      slopes->by_photocurrent(at + 1, k) = -m.current_by_photocurrent[c] / sigma_A;
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
  // Of a reading at the highest: few of those may lie between the others.
  constexpr double loss = 10.0;
  for (size_t row = 0; row < rows(); ++row) {
    const auto maxima = network(state, signals, row).maxima(LitNetwork::Which::with_corners, false);
    if (maxima.size() < 2) continue;
    const auto chi2 = off(row);
    const size_t held = held_maximum(maxima, true, chi2);
    gain[row] = held > 0 ? chi2(maxima[0]) - chi2(maxima[held]) : -loss;
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
    const LitNetwork at = network(state, signal, row);
    if (!holds_maximum()) {
      // The current at the measured voltage: an error of the current far above its own.
      constexpr double far = 1e6;
      const auto p = at.nearest(recording_.voltage_V[row], recording_.current_A[row],
                                lab_->noise().voltage_V, far * lab_->noise().current_A, false);
      e.voltage_V = recording_.voltage_V[row];
      e.current_A = p.current_A + current_law(state, row, e.voltage_V);
      continue;
    }
    const auto maxima = at.maxima(LitNetwork::Which::with_corners, false);
    if (maxima.empty()) continue;
    const auto& m = maxima[held_maximum(maxima, is_trapped(state, row), off(row))];
    e.voltage_V = m.voltage_V;
    e.current_A = m.current_A + current_law(state, row, m.voltage_V);
  }
  return result;
}

}  // namespace photorque
