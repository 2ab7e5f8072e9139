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

// Sums over the rows of one block. Attitudes are averaged as rotations from the first of them;
// their times are averaged with them, so that the mean belongs to the mean time.
struct Block {
  double first_time_s = 0.0;
  double time_sum_s = 0.0;
  int64_t rows = 0;
  Quat reference = Quat::Identity();
  Vec3 rotation_sum = Vec3::Zero();
  double attitude_time_sum_s = 0.0;
  int64_t attitudes = 0;
  Vec3 gyro_sum = Vec3::Zero();
  Vec3 gyro_time_sum_s = Vec3::Zero();
  Vec3 gyro_rows = Vec3::Zero();

  void add(double time_s, const Columns& columns, size_t row) {
    if (rows == 0) first_time_s = time_s;
    time_sum_s += time_s;
    ++rows;
    const Quat q = columns.attitude(row);
    if (std::isfinite(q.norm())) {
      if (attitudes == 0) reference = q.normalized();
      rotation_sum += rotation_vector(q.normalized() * reference.conjugate());
      attitude_time_sum_s += time_s;
      ++attitudes;
    }
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double rate = columns.rate(static_cast<size_t>(k), row);
      if (!std::isfinite(rate)) continue;
      gyro_sum[k] += rate;
      gyro_time_sum_s[k] += time_s;
      gyro_rows[k] += 1.0;
    }
  }

  Quat mean_attitude() const {
    if (attitudes == 0) return Quat(NAN, NAN, NAN, NAN);
    const Vec3 mean = rotation_sum / static_cast<double>(attitudes);
    const double angle = mean.norm();
    if (angle == 0.0) return reference;
    return (Quat(Eigen::AngleAxisd(angle, mean / angle)) * reference).normalized();
  }
};

void append(Observation& seen, const Block& block) {
  if (block.rows == 0) return;
  const double n = static_cast<double>(block.rows);
  // Where some rows lack the attitude, the block stands at the attitudes' mean time: they move.
  const double time_s = block.attitudes > 0
                            ? block.attitude_time_sum_s / static_cast<double>(block.attitudes)
                            : block.time_sum_s / n;
  seen.time_s.push_back(time_s);
  seen.attitude.push_back(block.mean_attitude());
  seen.attitude_rows.push_back(static_cast<double>(block.attitudes));
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

  const size_t rows = recording.rows();
  const double duration_s = recording.time_s.back() - recording.time_s.front();
  const double block_s =
      rows > most_blocks ? duration_s / static_cast<double>(most_blocks) : 0.0;
  Block block;
  for (size_t row = 0; row < rows; ++row) {
    const double time_s = recording.time_s[row];
    // Half a row of slack, so that rounding of the times does not make uneven blocks.
    const double end_s = block.first_time_s + block_s - 0.5 * seen.row_interval_s;
    if (block.rows > 0 && time_s > end_s) {
      append(seen, block);
      block = {};
    }
    block.add(time_s, columns, row);
  }
  append(seen, block);

  const auto attitudes = std::count_if(seen.attitude_rows.begin(), seen.attitude_rows.end(),
                                       [](double count) { return count > 0.0; });
  if (static_cast<size_t>(attitudes) < fewest_attitudes) {
    throw InputError({name, 0}, "q_w", std::to_string(attitudes) + " complete attitudes",
                     "at least " + std::to_string(fewest_attitudes));
  }
  return seen;
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
