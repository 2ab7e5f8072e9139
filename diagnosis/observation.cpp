#include "diagnosis/observation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/errors.h"

namespace photorque {
namespace {

constexpr size_t fewest_attitudes = 20;

struct Columns {
  std::array<const Channel*, 4> q{};
  std::array<const Channel*, 3> gyro{};
  bool has_gyro = false;

  Columns(const Recording& recording, const std::string& name) {
    const char* q_names[] = {"q_w", "q_x", "q_y", "q_z"};
    const char* gyro_names[] = {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"};
    for (size_t k = 0; k < 4; ++k) {
      q[k] = recording.find(q_names[k]);
      if (q[k] == nullptr) {
        throw InputError({name, 0}, "header", std::string("no channel ") + q_names[k],
                         "the attitude q_w, q_x, q_y, q_z");
      }
    }
    for (size_t k = 0; k < 3; ++k) {
      gyro[k] = recording.find(gyro_names[k]);
      has_gyro = has_gyro || gyro[k] != nullptr;
    }
  }
  Quat attitude(size_t row) const {
    return {q[0]->values[row], q[1]->values[row], q[2]->values[row], q[3]->values[row]};
  }
  double rate(size_t axis, size_t row) const {
    return gyro[axis] == nullptr ? NAN : gyro[axis]->values[row];
  }
};

// Weighted sums over readings that become one. Attitudes are averaged as rotations from the first
// of them, and the block stands at their mean time, because they move.
struct Block {
  double first_time_s = 0.0;
  double time_sum_s = 0.0;
  int64_t readings = 0;
  Quat reference = Quat::Identity();
  Vec3 rotation_sum = Vec3::Zero();
  double attitude_time_sum_s = 0.0;
  double attitude_rows = 0.0;
  Vec3 gyro_sum = Vec3::Zero();
  Vec3 gyro_rows = Vec3::Zero();

  void add(const Observation& from, size_t i) {
    if (readings == 0) first_time_s = from.time_s[i];
    time_sum_s += from.time_s[i];
    ++readings;
    const double rows = from.attitude_rows[i];
    if (rows > 0.0) {
      if (attitude_rows == 0.0) reference = from.attitude[i];
      rotation_sum += rows * rotation_vector(from.attitude[i] * reference.conjugate());
      attitude_time_sum_s += rows * from.time_s[i];
      attitude_rows += rows;
    }
    for (int k = 0; k < 3; ++k) {
      if (!(from.gyro_rows[i][k] > 0.0)) continue;
      gyro_sum[k] += from.gyro_rows[i][k] * from.gyro_rad_s[i][k];
      gyro_rows[k] += from.gyro_rows[i][k];
    }
  }

  Quat mean_attitude() const {
    if (attitude_rows == 0.0) return Quat(NAN, NAN, NAN, NAN);
    const Vec3 mean = rotation_sum / attitude_rows;
    const double angle = mean.norm();
    if (angle == 0.0) return reference;
    return (Quat(Eigen::AngleAxisd(angle, mean / angle)) * reference).normalized();
  }
};

void append(Observation& seen, const Block& block) {
  if (block.readings == 0) return;
  seen.time_s.push_back(block.attitude_rows > 0.0
                            ? block.attitude_time_sum_s / block.attitude_rows
                            : block.time_sum_s / static_cast<double>(block.readings));
  seen.attitude.push_back(block.mean_attitude());
  seen.attitude_rows.push_back(block.attitude_rows);
  seen.gyro_rows.push_back(block.gyro_rows);
  Vec3 rate = Vec3::Constant(NAN);
  for (int k = 0; k < 3; ++k) {
    if (block.gyro_rows[k] > 0.0) rate[k] = block.gyro_sum[k] / block.gyro_rows[k];
  }
  seen.gyro_rad_s.push_back(rate);
}

}  // namespace

Vec3 rotation_vector(const Quat& rotation) {
  const double sine = rotation.vec().norm(), side = std::copysign(1.0, rotation.w());
  if (sine < 1e-12) return 2.0 * side * rotation.vec();
  return 2.0 * side * std::atan2(sine, std::abs(rotation.w())) / sine * rotation.vec();
}

Observation observe(const Recording& recording, const std::string& name, size_t most_blocks) {
  const Columns columns(recording, name);
  Observation seen;
  seen.name = name;
  seen.schedule = recording.schedule();
  seen.has_gyro = columns.has_gyro;
  seen.rows = static_cast<int64_t>(recording.rows());
  seen.row_interval_s = recording.report.median_interval_s;
  seen.time_s = recording.time_s;
  size_t attitudes = 0;
  for (size_t row = 0; row < recording.rows(); ++row) {
    const Quat q = columns.attitude(row).normalized();
    const bool complete = q.coeffs().allFinite();
    attitudes += complete ? 1 : 0;
    seen.attitude.push_back(q);
    seen.attitude_rows.push_back(complete ? 1.0 : 0.0);
    const Vec3 rate(columns.rate(0, row), columns.rate(1, row), columns.rate(2, row));
    seen.gyro_rad_s.push_back(rate);
    seen.gyro_rows.push_back(rate.unaryExpr([](double x) { return std::isfinite(x) ? 1.0 : 0.0; }));
  }
  if (attitudes < fewest_attitudes) {
    throw InputError({name, 0}, "q_w", std::to_string(attitudes) + " complete attitudes",
                     "at least " + std::to_string(fewest_attitudes));
  }
  return seen.averaged(most_blocks);
}

Observation Observation::averaged(size_t most_blocks) const {
  if (blocks() <= most_blocks) return *this;
  Observation result = *this;
  result.time_s.clear();
  result.attitude.clear();
  result.attitude_rows.clear();
  result.gyro_rad_s.clear();
  result.gyro_rows.clear();
  const double block_s = duration_s() / static_cast<double>(most_blocks);
  Block block;
  for (size_t i = 0; i < blocks(); ++i) {
    // Half a row of slack, so that rounding of the times does not make uneven blocks.
    const double end_s = block.first_time_s + block_s - 0.5 * row_interval_s;
    if (block.readings > 0 && time_s[i] > end_s) {
      append(result, block);
      block = {};
    }
    block.add(*this, i);
  }
  append(result, block);
  return result;
}

Observation Observation::part(size_t first, size_t last) const {
  const auto cut = [&](auto& to, const auto& from) {
    to.assign(from.begin() + static_cast<std::ptrdiff_t>(first),
              from.begin() + static_cast<std::ptrdiff_t>(last));
  };
  Observation result = *this;
  cut(result.time_s, time_s);
  cut(result.attitude, attitude);
  cut(result.attitude_rows, attitude_rows);
  cut(result.gyro_rad_s, gyro_rad_s);
  cut(result.gyro_rows, gyro_rows);
  const double start_s = result.time_s.front();
  double from_s = time_s.front();
  for (size_t i = 0; i < schedule.time_s.size() && from_s < start_s; ++i) {
    const double until_s =
        i + 1 < schedule.time_s.size() ? std::min(start_s, schedule.time_s[i + 1]) : start_s;
    if (until_s <= from_s) continue;
    result.initial_charge_C += schedule.held[i].battery_current_A * (until_s - from_s);
    from_s = until_s;
  }
  return result;
}

}  // namespace photorque
