// Initial conditions of runs without readings of attitude: a search over many starts.

#include <algorithm>
#include <cmath>
#include <optional>

#include "attitude/estimation/fit.h"
#include "attitude/recordings/columns.h"
#include "core/constants.h"
#include "core/numerics/order.h"

namespace photorque {
namespace {

std::optional<double> first_of(const Observation& seen, Scalar scalar) {
  if (!seen.has(scalar)) return std::nullopt;
  const ScalarReadings& read = seen.scalar[static_cast<size_t>(scalar)];
  for (size_t i = 0; i < read.rows.size(); ++i) {
    if (read.rows[i] > 0.0) return read.value[i];
  }
  return std::nullopt;
}

// Attitudes with this tilt and yaw, in eight directions of the tilt; one attitude if the tilt is
// zero.
std::vector<Quat> tilted_attitudes(double tilt_rad, double yaw_rad) {
  constexpr int directions = 8;
  std::vector<Quat> all;
  for (int d = 0; d < directions; ++d) {
    const double towards = 2.0 * pi * d / directions;
    const Quat tilt(Eigen::AngleAxisd(tilt_rad, Vec3(-std::sin(towards), std::cos(towards), 0.0)));
    // The tilt also rotates body x slightly, by a second-order effect.
    double about_z = yaw_rad;
    Quat q;
    for (int i = 0; i < 8; ++i) {
      q = tilt * Quat(Eigen::AngleAxisd(about_z, Vec3::UnitZ()));
      const double now = scalar_reading(Scalar::yaw, q, Vec3::Zero()).value;
      about_z += scalar_difference(Scalar::yaw, yaw_rad, now);
    }
    all.push_back(q);
    if (!(tilt_rad > 0.0)) break;
  }
  return all;
}

std::optional<Vec3> first_of_three(const Observation& seen, Scalar first) {
  Vec3 all;
  for (int k = 0; k < 3; ++k) {
    const auto one = first_of(seen, static_cast<Scalar>(static_cast<int>(first) + k));
    if (!one) return std::nullopt;
    all[k] = *one;
  }
  return all;
}

// The attitude from two directions that are known in the lab and measured in the body (H. D. Black,
// AIAA Journal 2 (1964) 1350). The first direction is matched exactly, the second as well as
// possible.
Quat attitude_from_two(const Vec3& first_lab, const Vec3& second_lab, const Vec3& first_body,
                       const Vec3& second_body) {
  const auto frame = [](const Vec3& a, const Vec3& b) {
    Mat3 m;
    m.col(0) = a.normalized();
    m.col(1) = a.cross(b).normalized();
    m.col(2) = m.col(0).cross(m.col(1));
    return m;
  };
  return Quat(Mat3(frame(first_lab, second_lab) * frame(first_body, second_body).transpose()));
}

// Initial attitudes from the measured directions of gravity and magnetic field. With only one of
// them, four rotations about its direction.
std::vector<Quat> attitudes_by_fields(const AttitudeModel& model, const Observation& seen) {
  const auto force = first_of_three(seen, Scalar::accelerometer_x);
  const auto field = first_of_three(seen, Scalar::magnetometer_x);
  const Vec3 field_lab = model.environment.magnetic_field_lab_T;
  const Vec3 up_lab = -model.environment.gravity_lab_m_s2;
  const bool has_weight = force && model.platform.has_bearing() && up_lab.norm() > 0.0;
  const bool has_field = field && field_lab.norm() > 0.0;
  if (has_weight && has_field) return {attitude_from_two(up_lab, field_lab, *force, *field)};
  if (!has_weight && !has_field) return {};
  const Quat found =
      has_weight ? rotation_between(*force, up_lab) : rotation_between(*field, field_lab);
  const Vec3 about = has_weight ? up_lab.normalized() : field_lab.normalized();
  constexpr int headings = 4;
  std::vector<Quat> all;
  for (int i = 0; i < headings; ++i) {
    all.push_back(Quat(Eigen::AngleAxisd(2.0 * pi * i / headings, about)) * found);
  }
  return all;
}

std::vector<Quat> attitudes_of(const AttitudeModel& model, const Observation& seen,
                               const Quat& otherwise) {
  if (auto by_fields = attitudes_by_fields(model, seen); !by_fields.empty()) {
    return by_fields;
  }
  const auto roll = first_of(seen, Scalar::roll), pitch = first_of(seen, Scalar::pitch);
  const auto tilt = first_of(seen, Scalar::tilt), yaw = first_of(seen, Scalar::yaw);
  const double about_z = yaw.value_or(0.0);
  if (roll || pitch) {
    return {attitude_of_angles("zyx", {roll.value_or(0.0), pitch.value_or(0.0), about_z})};
  }
  if (!tilt && !yaw) return {otherwise};
  return tilted_attitudes(tilt.value_or(0.0), about_z);
}

// Initial rates to try. Measured axes keep the rates of `base`. The rest of the measured magnitude
// is along all directions of the unmeasured axes.
std::vector<Vec3> rates_of(const Observation& seen, const Vec3& base, const Quat& attitude) {
  std::array<bool, 3> is_read{};
  for (int k = 0; k < 3; ++k) {
    is_read[static_cast<size_t>(k)] = std::any_of(seen.gyro_rows.begin(), seen.gyro_rows.end(),
                                                  [&](const Vec3& rows) { return rows[k] > 0.0; });
  }
  if (is_read[0] && is_read[1] && is_read[2]) return {base};
  const auto magnitude = first_of(seen, Scalar::rate_magnitude);
  Vec3 known = base;
  for (int k = 0; k < 3; ++k) {
    if (!is_read[static_cast<size_t>(k)]) known[k] = 0.0;
  }
  if (!magnitude) {
    constexpr int most = 10;
    const double about_z = first_line(seen, Scalar::yaw, most).slope_1_s;
    const Vec3 rate = attitude.conjugate() * Vec3(0.0, 0.0, about_z);
    for (int k = 0; k < 3; ++k) {
      if (!is_read[static_cast<size_t>(k)]) known[k] = rate[k];
    }
    return {known};
  }
  const double rest = std::sqrt(std::max(0.0, *magnitude * *magnitude - known.squaredNorm()));
  std::vector<Vec3> all;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const Vec3 towards(x, y, z);
        bool is_free = towards.norm() > 0.0;
        for (int k = 0; k < 3; ++k) {
          is_free = is_free && !(is_read[static_cast<size_t>(k)] && towards[k] != 0.0);
        }
        if (is_free) all.emplace_back(known + rest * towards.normalized());
      }
    }
  }
  return all;
}

struct FittedStart {
  RunStart start;
  double chi2;
};

// Fits the first blocks of one run.
FittedStart begun_from(const Hypothesis& h, const RunStart& start, const Observation& seen) {
  constexpr int iterations = 20;
  Hypothesis one = h;
  one.runs = {start};
  FitSettings settings;
  settings.windows = {0.1, 0.3, 1.0};
  settings.max_iterations = iterations;
  const Fit fitted = fit(one, {seen}, settings);
  return {fitted.best.runs.empty() ? start : fitted.best.runs.front(), fitted.chi2};
}

// The start rotated by half a turn about the vertical. If gravity is the only known direction,
// readings of a tilt do not distinguish it from the original; only priors do.
RunStart mirrored(RunStart start) {
  const Quat half(Eigen::AngleAxisd(pi, Vec3::UnitZ()));
  start.initial.lab_from_body = half * start.initial.lab_from_body * half.conjugate();
  start.initial.rate_body_rad_s = half * start.initial.rate_body_rad_s;
  return start;
}

RunStart best_start(const Hypothesis& h, const RunStart& given, const Observation& seen) {
  constexpr size_t few_blocks = 200, more_blocks = 1000, most_kept = 4;
  std::vector<RunStart> starts;
  for (const Quat& attitude : attitudes_of(h.model, seen, given.initial.lab_from_body)) {
    for (const Vec3& rate : rates_of(seen, given.initial.rate_body_rad_s, attitude)) {
      RunStart start = given;
      start.initial.lab_from_body = attitude;
      start.initial.rate_body_rad_s = rate;
      starts.push_back(start);
    }
  }
  if (starts.size() == 1) return starts.front();
  for (const size_t blocks : {few_blocks, more_blocks}) {
    const Observation beginning = seen.part(0, std::min(blocks, seen.blocks()));
    std::vector<FittedStart> all;
    for (const RunStart& start : starts) all.push_back(begun_from(h, start, beginning));
    starts.clear();
    for (const size_t i : sorted_indices(
             all.size(), [&](size_t a, size_t b) { return all[a].chi2 < all[b].chi2; })) {
      if (starts.size() < most_kept) starts.push_back(all[i].start);
    }
    if (blocks == few_blocks && seen.has(Scalar::tilt)) {
      const size_t kept = starts.size();
      for (size_t i = 0; i < kept; ++i) starts.push_back(mirrored(starts[i]));
    }
  }
  return starts.front();
}

}  // namespace

void choose_starts(Hypothesis& hypothesis, const std::vector<Observation>& runs) {
  for (size_t run = 0; run < runs.size(); ++run) {
    const Observation& seen = runs[run];
    if (seen.has_some_attitude() || !seen.has_scalars()) continue;
    hypothesis.runs[run] = best_start(hypothesis, hypothesis.runs[run], seen);
  }
}

}  // namespace photorque
