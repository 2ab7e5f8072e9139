#include "attitude/estimation/averaging.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "attitude/estimation/fit.h"
#include "attitude/observation/block_means.h"

namespace photorque {
namespace {

// Residuals of neighbours on their way to one.
struct Neighbours {
  size_t first = 0, last = 0;
  double time_sum_s = 0.0;
  Vec3 attitude_sum = Vec3::Zero(), gyro_sum = Vec3::Zero();
  double attitude_rows = 0.0;
  Vec3 gyro_rows = Vec3::Zero();
  std::array<double, scalar_count> scalar_sum = {}, scalar_rows = {};

  void add(const Observation& from, const Prediction& propagated, size_t i) {
    if (last == first) first = i;
    last = i + 1;
    time_sum_s += from.time_s[i];
    const WhiteRow& off = propagated.off[i];
    const double rows = from.attitude_rows[i];
    if (rows > 0.0) {
      attitude_sum += rows * off.head<3>();
      attitude_rows += rows;
    }
    for (int k = 0; k < 3; ++k) {
      const double read = from.gyro_rows[i][k];
      if (!(read > 0.0)) continue;
      gyro_sum[k] += read * off[3 + k];
      gyro_rows[k] += read;
    }
    for (int s = 0; s < scalar_count; ++s) {
      const double read = from.rows_of(i, vector_channels + s);
      if (!(read > 0.0)) continue;
      scalar_sum[static_cast<size_t>(s)] += read * off[vector_channels + s];
      scalar_rows[static_cast<size_t>(s)] += read;
    }
  }

  size_t middle(const Observation& from) const {
    const double mean_s = time_sum_s / static_cast<double>(last - first);
    size_t best = first;
    for (size_t i = first; i < last; ++i) {
      if (std::abs(from.time_s[i] - mean_s) < std::abs(from.time_s[best] - mean_s)) best = i;
    }
    return best;
  }

  void append_to(Observation& to, const Observation& from, const Prediction& propagated) const {
    const size_t m = middle(from);
    to.time_s.push_back(from.time_s[m]);
    // Residuals hold no curvature: what there is, is that of the middle one.
    if (!from.spread.empty()) {
      to.spread.push_back(from.spread[m]);
      to.spread.back().gyro_moved_rad_s.setZero();
    }
    Quat attitude(NAN, NAN, NAN, NAN);
    if (attitude_rows > 0.0) {
      const Vec3 turn = propagated.camera_offset_lab_rad[m] + attitude_sum / attitude_rows;
      attitude = propagated.states[m].lab_from_body;
      if (const double angle = turn.norm(); angle > 0.0) {
        attitude = (Quat(Eigen::AngleAxisd(angle, turn / angle)) * attitude).normalized();
      }
    }
    to.attitude.push_back(attitude);
    to.attitude_rows.push_back(attitude_rows);
    Vec3 rate = Vec3::Constant(NAN);
    for (int k = 0; k < 3; ++k) {
      if (gyro_rows[k] > 0.0) rate[k] = propagated.gyro_rad_s[m][k] + gyro_sum[k] / gyro_rows[k];
    }
    to.gyro_rad_s.push_back(rate);
    to.gyro_rows.push_back(gyro_rows);
    for (size_t s = 0; s < from.scalar.size(); ++s) {
      if (from.scalar[s].rows.empty()) continue;
      const double mean = scalar_rows[s] > 0.0 ? scalar_sum[s] / scalar_rows[s] : NAN;
      to.scalar[s].value.push_back(propagated.scalars[m][static_cast<Eigen::Index>(s)] + mean);
      to.scalar[s].rows.push_back(scalar_rows[s]);
    }
  }
};

Observation averaged_run(const Prediction& propagated, const Observation& seen, size_t blocks) {
  Observation result = without_blocks(seen);
  const double block_s = seen.duration_s() / static_cast<double>(blocks);
  // Half a reading of slack, so that rounding of the times does not make uneven blocks.
  const double slack_s = 0.5 * seen.duration_s() / static_cast<double>(seen.blocks());
  Neighbours block;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    if (block.last > block.first && seen.time_s[i] > seen.time_s[block.first] + block_s - slack_s) {
      block.append_to(result, seen, propagated);
      block = {};
    }
    block.add(seen, propagated, i);
  }
  block.append_to(result, seen, propagated);
  return result;
}

}  // namespace

std::vector<Observation> averaged_about(const Fit& fit, const std::vector<Observation>& runs,
                                        size_t blocks) {
  const std::vector<Prediction> propagated = residuals_of(fit, runs);
  std::vector<Observation> result;
  for (size_t run = 0; run < runs.size(); ++run) {
    result.push_back(runs[run].blocks() <= blocks
                         ? runs[run]
                         : averaged_run(propagated[run], runs[run], blocks));
  }
  return result;
}

}  // namespace photorque
