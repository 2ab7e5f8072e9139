#include "diagnosis/light/model/run.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/numerics/median.h"

namespace photorque {
namespace {

constexpr size_t no_cell = static_cast<size_t>(-1);

template <class T>
std::vector<T> chosen(const std::vector<T>& all, const std::vector<size_t>& rows) {
  std::vector<T> result;
  if (all.empty()) return result;
  result.reserve(rows.size());
  for (const size_t row : rows) result.push_back(all[row]);
  return result;
}

bool same_rotation(const Quat& a, const Quat& b) {
  return a.coeffs() == b.coeffs();
}

}  // namespace

LightRun::LightRun(const LightLab& lab, LightRecording recording)
    : LightRun(lab, std::move(recording), nullptr) {}

LightRun::LightRun(const LightLab& lab, LightRecording recording, const PartOf* known)
    : lab_(&lab), recording_(std::move(recording)) {
  if (!is_scan() && !lab.has_array()) {
    throw InputError({recording_.name}, "array", "no table [array] in the experiment",
                     "one, for a recording of voltages and currents");
  }
  if (is_scan()) {
    place_scan();
  } else {
    place_cells();
  }
  face_walls();
  find_noise();
  find_circumstances(known);
  number_samples();
}

void LightRun::place_scan() {
  const LightRecording& r = recording_;
  for (size_t i = 0; i < r.rows(); ++i) {
    if (i == 0 || !same_rotation(r.lab_from_body[i], sites_.lab_from_body.back())) {
      sites_.lab_from_body.push_back(r.lab_from_body[i]);
    }
    sites_.points_body_m.push_back(lab_->point_body_m(r.u_m[i], r.v_m[i]));
    sites_.weights.push_back(1.0);
    sites_.groups.push_back({i, 1});
    sites_.outputs.push_back({sites_.lab_from_body.size() - 1, i});
    first_output_.push_back(i);
    size_t cell = no_cell;
    for (size_t c = 0; c < lab_->cells().size(); ++c) {
      const CellRectangle& at = lab_->cells()[c].rectangle;
      if (r.u_m[i] >= at.u_low && r.u_m[i] < at.u_high && r.v_m[i] >= at.v_low &&
          r.v_m[i] < at.v_high) {
        cell = c;
      }
    }
    cell_of_point_.push_back(cell);
  }
}

void LightRun::place_cells() {
  sites_.enters_cells = true;
  for (const LightCell& cell : lab_->cells()) {
    sites_.groups.push_back({sites_.points_body_m.size(), cell.points_body_m.size()});
    sites_.points_body_m.insert(sites_.points_body_m.end(), cell.points_body_m.begin(),
                                cell.points_body_m.end());
    sites_.weights.insert(sites_.weights.end(), cell.weights.begin(), cell.weights.end());
  }
  const LightRecording& r = recording_;
  const size_t cells = lab_->cells().size();
  if (is_run()) {
    for (size_t i = 0; i < r.rows(); ++i) first_output_.push_back(i * cells);
    choose_knots();
    return;
  }
  for (size_t i = 0; i < r.rows(); ++i) {
    const bool again = i > 0 && same_rotation(r.lab_from_body[i], r.lab_from_body[i - 1]) &&
                       r.temperature_K[i] == r.temperature_K[i - 1];
    if (!again) {
      sites_.lab_from_body.push_back(r.lab_from_body[i]);
      for (size_t c = 0; c < cells; ++c) {
        sites_.outputs.push_back({sites_.lab_from_body.size() - 1, c});
      }
    }
    first_output_.push_back(sites_.outputs.size() - cells);
    auto& known = cells_at_[r.temperature_K[i]];
    if (known.empty()) known = lab_->cell_laws(r.temperature_K[i], 0.0, true);
  }
}

void LightRun::face_walls() {
  for (size_t w = 0; w < lab_->walls().size(); ++w) {
    exchange_.push_back(std::make_shared<const WallExchange>(exchange_with(*lab_, sites_, w)));
  }
}

// A platform moves smoothly, and so the light on its cells varies smoothly. It is evaluated at some
// rows and interpolated by cubics in time. Between knots, cells move by a small fraction of the
// steepest spot's standard deviation: at a tenth of it a cubic errs by some 1e-5 of the light.
void LightRun::choose_knots() {
  const LightRecording& r = recording_;
  constexpr double of_edge = 0.1, least_rad = 0.002, most_rad = 0.03, beside_walls_rad = 0.006;
  double reach_m = 0.0;
  for (const LightCell& cell : lab_->cells()) {
    for (const Vec3& p : cell.points_body_m) reach_m = std::max(reach_m, p.norm());
  }
  const double largest_rad = std::clamp(of_edge * lab_->narrowest_edge_m() / reach_m, least_rad,
                                        lab_->walls().empty() ? most_rad : beside_walls_rad);
  constexpr size_t most_rows = 64;
  std::vector<double> intervals;
  for (size_t i = 1; i < r.rows(); ++i) intervals.push_back(r.time_s[i] - r.time_s[i - 1]);
  const double usual_s = intervals.empty() ? 1.0 : upper_median(intervals);
  const auto turned = [&](size_t a, size_t b) {
    return r.lab_from_body[a].angularDistance(r.lab_from_body[b]);
  };
  std::vector<size_t> knots;
  between_.resize(r.rows());
  for (size_t first = 0, last = 0; first < r.rows(); first = last) {
    last = first + 1;
    while (last < r.rows() && turned(last, last - 1) < 2.0 * largest_rad &&
           r.time_s[last] > r.time_s[last - 1] &&
           r.time_s[last] - r.time_s[last - 1] < 5.0 * usual_s) {
      ++last;
    }
    const size_t begin = knots.size();
    for (size_t i = first; i < last; ++i) {
      const bool few = last - first < 8;
      if (i == first || i + 1 == last || few || turned(i, knots.back()) > largest_rad ||
          i - knots.back() >= std::min(most_rows, (last - first) / 5)) {
        knots.push_back(i);
      }
    }
    const size_t count = std::min<size_t>(4, knots.size() - begin);
    size_t at = begin;
    for (size_t i = first; i < last; ++i) {
      while (at + 1 < knots.size() && knots[at + 1] <= i) ++at;
      const size_t from =
          std::clamp(at, begin + 1, std::max(begin + 1, knots.size() - count + 1)) - 1;
      Between& b = between_[i];
      for (size_t k = 0; k < count; ++k) {
        double weight = 1.0;
        for (size_t m = 0; m < count; ++m) {
          if (m == k) continue;
          weight *= (r.time_s[i] - r.time_s[knots[from + m]]) /
                    (r.time_s[knots[from + k]] - r.time_s[knots[from + m]]);
        }
        b.knot[k] = static_cast<uint32_t>(from + k);
        b.weight[k] = weight;
      }
    }
  }
  for (const size_t row : knots) {
    sites_.lab_from_body.push_back(r.lab_from_body[row]);
    for (size_t c = 0; c < lab_->cells().size(); ++c) {
      sites_.outputs.push_back({sites_.lab_from_body.size() - 1, c});
    }
  }
}

LampField LightRun::expanded(LampField field) const {
  if (between_.empty()) return field;
  const size_t cells = lab_->cells().size();
  LampField all(rows() * cells, 0.0);
  for (size_t row = 0; row < rows(); ++row) {
    for (size_t k = 0; k < 4; ++k) {
      const double weight = between_[row].weight[k];
      if (weight == 0.0) continue;
      const size_t from = between_[row].knot[k] * cells;
      for (size_t c = 0; c < cells; ++c) all[row * cells + c] += weight * field[from + c];
    }
  }
  return all;
}

void LightRun::find_noise() {
  const LightNoise& noise = lab_->noise();
  if (!is_scan()) {
    // Squares of readings divided by a smaller noise would overflow.
    constexpr double least = 1e-12;
    if (!(noise.voltage_V >= least) || !(noise.current_A >= least)) {
      throw InputError(
          {lab_->experiment().file.path.string()}, "sensors.array", "no noise",
          "voltage_noise_V and current_noise_A, the errors of a reading: 1e-12 or more");
    }
    voltage_scale_V_ = std::max(1e-9, *std::ranges::max_element(recording_.voltage_V));
    current_scale_A_ = std::max(1e-9, *std::ranges::max_element(recording_.current_A));
    return;
  }
  if (!(noise.irradiance_W_m2 > 0.0) && !(noise.relative > 0.0)) {
    throw InputError({lab_->experiment().file.path.string()}, "sensors.irradiance", "no noise",
                     "noise_W_m2 or relative_noise > 0, the error of a reading");
  }
  // Relative noise refers to the local median instead of each reading: otherwise the reading's
  // noise would give low readings a higher weight.
  const std::vector<double>& E = recording_.irradiance_W_m2;
  const double floor_W_m2 = 1e-3 * upper_median(E);
  for (size_t i = 0; i < E.size(); ++i) {
    constexpr size_t reach = 3;
    std::vector<double> near;
    for (size_t j = i > reach ? i - reach : 0; j <= std::min(i + reach, E.size() - 1); ++j) {
      if (j == i || recording_.v_m[j] == recording_.v_m[i]) near.push_back(E[j]);
    }
    const double level = upper_median(near);
    irradiance_sigma_.push_back(
        std::max(std::hypot(noise.irradiance_W_m2, noise.relative * level), 1e-6 * floor_W_m2));
  }
}

void LightRun::find_circumstances(const PartOf* known) {
  const SurfaceGrid& g = lab_->grid();
  const auto over = [](double x, double low, double high) {
    return high > low ? 2.0 * (x - low) / (high - low) - 1.0 : 0.0;
  };
  circumstances_.resize(between_.empty() ? sites_.outputs.size() : rows() * lab_->cells().size());
  for (size_t row = 0; row < recording_.rows(); ++row) {
    const Vec3 up = recording_.lab_from_body[row] * Vec3::UnitZ();
    SampleConditions c;
    c.tilt_rad = std::acos(std::clamp(up.z(), -1.0, 1.0));
    c.heading_rad = std::atan2(up.y(), up.x());
    c.temperature_K = recording_.temperature_K[row];
    if (is_run()) c.time_s = recording_.time_s[row];
    if (is_scan()) {
      c.u = over(recording_.u_m[row], g.u_low, g.u_high);
      c.v = over(recording_.v_m[row], g.v_low, g.v_high);
      circumstances_[row] = c;
      continue;
    }
    for (size_t k = 0; k < lab_->cells().size(); ++k) {
      const CellRectangle& at = lab_->cells()[k].rectangle;
      c.u = over(0.5 * (at.u_low + at.u_high), g.u_low, g.u_high);
      c.v = over(0.5 * (at.v_low + at.v_high), g.v_low, g.v_high);
      circumstances_[first_output_[row] + k] = c;
    }
  }
  if (known != nullptr && is_scan()) {
    for (size_t i = 0; i < rows(); ++i) {
      circumstances_[i].irradiance = known->whole->circumstances_[(*known->rows)[i]].irradiance;
    }
    return;
  }
  const LightState nominal = lab_->nominal();
  const std::vector<double> light = signals(nominal, fields(nominal, nullptr));
  const double most = std::max(1e-300, *std::ranges::max_element(light));
  for (size_t o = 0; o < light.size(); ++o) circumstances_[o].irradiance = light[o] / most;
}

void LightRun::number_samples() {
  sample_row_.clear();
  sample_channel_.clear();
  if (is_scan()) {
    channels_ = {{"irradiance_W_m2", &LightRecording::irradiance_W_m2, &Expected::irradiance_W_m2}};
  } else {
    channels_ = {{is_run() ? "array_current_A" : "current_A", &LightRecording::current_A,
                  &Expected::current_A}};
    if (holds_maximum()) {
      channels_.insert(channels_.begin(),
                       {"array_voltage_V", &LightRecording::voltage_V, &Expected::voltage_V});
    }
  }
  for (size_t row = 0; row < recording_.rows(); ++row) {
    for (size_t c = 0; c < channels_.size(); ++c) {
      sample_row_.push_back(row);
      sample_channel_.push_back(static_cast<int>(c));
    }
  }
}

void LightRun::keep_scales_of(const LightRun& whole) {
  voltage_scale_V_ = whole.voltage_scale_V_;
  current_scale_A_ = whole.current_scale_A_;
  number_ = whole.number_;
}

LightRun LightRun::part(const std::vector<size_t>& rows) const {
  const PartOf known{this, &rows};
  LightRun run(*lab_, recording_.part(rows), &known);
  run.keep_scales_of(*this);
  if (is_scan()) run.irradiance_sigma_ = chosen(irradiance_sigma_, rows);
  return run;
}

LightRun LightRun::in(const LightLab& lab) const {
  LightRecording there = recording_;
  if (!there.has_attitudes) {
    std::ranges::fill(there.lab_from_body, lab.experiment().lab_from_body.rotation);
  }
  if (!there.has_temperatures && lab.has_array()) {
    std::ranges::fill(there.temperature_K, lab.design().temperature_K);
  }
  LightRun run(lab, std::move(there));
  run.keep_scales_of(*this);
  run.irradiance_sigma_ = irradiance_sigma_;
  return run;
}

}  // namespace photorque
