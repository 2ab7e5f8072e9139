#include "core/wrench.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/errors.h"

namespace photorque {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

}  // namespace

WrenchEstimate wrench_from_replicates(std::span<const WrenchComponents> replicates,
                                      const Vec3& about_m, Frame frame) {
  const double count = static_cast<double>(replicates.size());
  Vec6 mean = Vec6::Zero();
  for (const WrenchComponents& replicate : replicates) mean += Vec6(replicate.data()) / count;
  Mat6 covariance = Mat6::Zero();
  for (const WrenchComponents& replicate : replicates) {
    const Vec6 deviation = Vec6(replicate.data()) - mean;
    covariance += deviation * deviation.transpose() / (count * (count - 1.0));
  }
  return {{mean.head<3>(), mean.tail<3>(), about_m, frame}, covariance};
}

Wrench wrench_about(const Wrench& wrench, const Vec3& about_m) {
  Wrench moved = wrench;
  moved.torque_N_m += (wrench.about_m - about_m).cross(wrench.force_N);
  moved.about_m = about_m;
  return moved;
}

WrenchEstimate wrench_about(const WrenchEstimate& wrench, const Vec3& about_m) {
  Mat6 shift = Mat6::Identity();
  shift.bottomLeftCorner<3, 3>() = skew(wrench.mean.about_m - about_m);
  return {wrench_about(wrench.mean, about_m), shift * wrench.covariance * shift.transpose()};
}

namespace {

constexpr double angle_slack_rad = 1e-9;

// Position between two nodes of an axis: value = (1 − weight)·[low] + weight·[high].
struct Bracket {
  size_t low = 0;
  size_t high = 0;
  double weight = 0.0;
};

struct AngleRange {
  double low_rad, high_rad;
};

AngleRange polar_range(WrenchTable::Angles angles) {
  return angles == WrenchTable::Angles::tilt_heading ? AngleRange{0.0, pi}
                                                     : AngleRange{-pi / 2, pi / 2};
}

bool is_pole(const WrenchTable& table, double polar_rad) {
  const AngleRange range = polar_range(table.angles);
  return std::abs(polar_rad - range.low_rad) < angle_slack_rad ||
         std::abs(polar_rad - range.high_rad) < angle_slack_rad;
}

std::string degrees(double angle_rad) {
  return std::to_string(angle_rad / degree_rad) + " deg";
}

void check_axis(const std::vector<double>& axis_rad, AngleRange range, const std::string& name) {
  const std::string expected = "at least one angle, ascending, from " + degrees(range.low_rad) +
                               " to " + degrees(range.high_rad);
  if (axis_rad.empty()) throw InputError({}, name, "none", expected);
  for (size_t i = 0; i < axis_rad.size(); ++i) {
    const bool ascends = i == 0 || axis_rad[i] > axis_rad[i - 1];
    const bool inside = axis_rad[i] >= range.low_rad - angle_slack_rad &&
                        axis_rad[i] <= range.high_rad + angle_slack_rad;
    if (!ascends || !inside) throw InputError({}, name, degrees(axis_rad[i]), expected);
  }
}

Bracket bracket(const std::vector<double>& axis_rad, double angle_rad, const char* name) {
  const double low = axis_rad.front(), high = axis_rad.back();
  if (!(angle_rad >= low - angle_slack_rad && angle_rad <= high + angle_slack_rad)) {
    throw NumericalError(std::string("wrench table: ") + name + " " + degrees(angle_rad) +
                         " is outside the table, which goes from " + degrees(low) + " to " +
                         degrees(high));
  }
  if (axis_rad.size() == 1) return {};
  const auto above = std::upper_bound(axis_rad.begin(), axis_rad.end(), angle_rad);
  const auto last = static_cast<std::ptrdiff_t>(axis_rad.size()) - 1;
  const auto high_index =
      static_cast<size_t>(std::clamp<std::ptrdiff_t>(above - axis_rad.begin(), 1, last));
  const double from = axis_rad[high_index - 1], to = axis_rad[high_index];
  return {high_index - 1, high_index, std::clamp((angle_rad - from) / (to - from), 0.0, 1.0)};
}

// The second angle is periodic. It is reduced to the turn of the table. The gap between the last
// node and the first is interpolated if it is not wider than the widest step of the table.
Bracket bracket_around(const std::vector<double>& axis_rad, double angle_rad) {
  const double low = axis_rad.front();
  double turned = low + std::fmod(angle_rad - low, 2 * pi);
  if (turned < low - angle_slack_rad) turned += 2 * pi;
  if (turned > low + 2 * pi - angle_slack_rad) turned -= 2 * pi;
  const double gap = low + 2 * pi - axis_rad.back();
  double widest = 0.0;
  for (size_t i = 1; i < axis_rad.size(); ++i) {
    widest = std::max(widest, axis_rad[i] - axis_rad[i - 1]);
  }
  if (turned > axis_rad.back() && gap <= widest + angle_slack_rad) {
    return {axis_rad.size() - 1, 0, (turned - axis_rad.back()) / gap};
  }
  return bracket(axis_rad, turned, "heading or azimuth");
}

// Groups of two or more nodes that are the same attitude.
std::vector<std::vector<size_t>> equal_nodes(const WrenchTable& table) {
  std::vector<std::vector<size_t>> groups;
  const bool closed = table.around_rad.back() - table.around_rad.front() > 2 * pi - angle_slack_rad;
  for (size_t polar = 0; polar < table.polar_rad.size(); ++polar) {
    if (is_pole(table, table.polar_rad[polar])) {
      groups.emplace_back();
      for (size_t around = 0; around < table.around_rad.size(); ++around) {
        groups.back().push_back(table.node(around, polar));
      }
    } else if (closed) {
      groups.push_back({table.node(0, polar), table.node(table.around_rad.size() - 1, polar)});
    }
  }
  return groups;
}

void average(std::vector<Vec3>& values, const std::vector<size_t>& nodes) {
  Vec3 sum = Vec3::Zero();
  for (const size_t node : nodes) sum += values[node];
  for (const size_t node : nodes) values[node] = sum / static_cast<double>(nodes.size());
}

// Replaces the errors of equal nodes by their root mean square. Nodes traced with one seed have
// equal noise, so their mean is no more accurate than each of them.
void average_errors(std::vector<Vec3>& errors, const std::vector<size_t>& nodes) {
  Vec3 squares = Vec3::Zero();
  for (const size_t node : nodes) squares += errors[node].cwiseAbs2();
  const Vec3 error = (squares / static_cast<double>(nodes.size())).cwiseSqrt();
  for (const size_t node : nodes) errors[node] = error;
}

}  // namespace

WrenchTable make_wrench_table(WrenchTable::Angles angles, std::vector<double> polar_rad,
                              std::vector<double> around_rad, const Vec3& about_body_m) {
  const bool tilt = angles == WrenchTable::Angles::tilt_heading;
  check_axis(polar_rad, polar_range(angles), tilt ? "tilt" : "elevation");
  const double start = around_rad.empty() ? 0.0 : around_rad.front();
  check_axis(around_rad, {start, start + 2 * pi}, tilt ? "heading" : "azimuth");

  WrenchTable table;
  table.angles = angles;
  table.polar_rad = std::move(polar_rad);
  table.around_rad = std::move(around_rad);
  table.about_body_m = about_body_m;
  for (auto* column : {&table.force_body_N, &table.torque_body_N_m, &table.force_error_N,
                       &table.torque_error_N_m}) {
    column->assign(table.nodes(), Vec3::Zero());
  }
  return table;
}

void set_node(WrenchTable& table, size_t node, const WrenchEstimate& wrench) {
  const WrenchEstimate moved = wrench_about(wrench, table.about_body_m);
  table.force_body_N[node] = moved.mean.force_N;
  table.torque_body_N_m[node] = moved.mean.torque_N_m;
  table.force_error_N[node] = moved.force_error_N();
  table.torque_error_N_m[node] = moved.torque_error_N_m();
}

Wrench wrench_at(const WrenchTable& table, const TableAngles& angles) {
  const Bracket p = bracket(table.polar_rad, angles.polar_rad, "tilt or elevation");
  const Bracket a = is_pole(table, angles.polar_rad)
                        ? Bracket{}
                        : bracket_around(table.around_rad, angles.around_rad);
  Wrench wrench;
  wrench.about_m = table.about_body_m;
  const auto add = [&](size_t around, size_t polar, double weight) {
    wrench.force_N += weight * table.force_body_N[table.node(around, polar)];
    wrench.torque_N_m += weight * table.torque_body_N_m[table.node(around, polar)];
  };
  add(a.low, p.low, (1 - a.weight) * (1 - p.weight));
  add(a.low, p.high, (1 - a.weight) * p.weight);
  add(a.high, p.low, a.weight * (1 - p.weight));
  add(a.high, p.high, a.weight * p.weight);
  return wrench;
}

TableAngles azimuth_and_elevation(const Vec3& towards_light_body) {
  const Vec3& d = towards_light_body;
  return {std::atan2(d.z(), std::hypot(d.x(), d.y())), std::atan2(d.y(), d.x())};
}

Vec3 towards_light(const TableAngles& azimuth_elevation) {
  const double cosine = std::cos(azimuth_elevation.polar_rad);
  return {cosine * std::cos(azimuth_elevation.around_rad),
          cosine * std::sin(azimuth_elevation.around_rad), std::sin(azimuth_elevation.polar_rad)};
}

WrenchTable single_valued(const WrenchTable& table) {
  WrenchTable result = table;
  for (const auto& nodes : equal_nodes(table)) {
    average(result.force_body_N, nodes);
    average(result.torque_body_N_m, nodes);
    average_errors(result.force_error_N, nodes);
    average_errors(result.torque_error_N_m, nodes);
  }
  return result;
}

WrenchTable scaled(const WrenchTable& table, double factor) {
  WrenchTable result = table;
  for (auto* column : {&result.force_body_N, &result.torque_body_N_m}) {
    for (Vec3& value : *column) value *= factor;
  }
  for (auto* column : {&result.force_error_N, &result.torque_error_N_m}) {
    for (Vec3& value : *column) value *= std::abs(factor);
  }
  return result;
}

double mean_push_N(const WrenchTable& table) {
  double push = 0.0, weights = 0.0;
  for (size_t around = 0; around < table.around_rad.size(); ++around) {
    for (size_t polar = 0; polar < table.polar_rad.size(); ++polar) {
      const TableAngles angles{table.polar_rad[polar], table.around_rad[around]};
      const double weight = std::cos(angles.polar_rad);
      push -= weight * table.force_body_N[table.node(around, polar)].dot(towards_light(angles));
      weights += weight;
    }
  }
  return weights > 0.0 ? push / weights : 0.0;
}

}  // namespace photorque
