// Recorded commands, currents and wheel speeds as a schedule.
#include <algorithm>
#include <cmath>

#include "attitude/recordings/recording.h"
#include "core/errors.h"
#include "core/numerics/series.h"

namespace photorque {
namespace {

// The recorded current of a laboratory's lamps, one value per row; rows before the first reading
// have its value. Changes below a hundredth of the largest current are treated as noise and
// replaced by their mean, because each change starts a step of the propagation. Empty without the
// channel, and if no lamp is lit.
std::vector<double> lamp_currents_A(const Channel* channel) {
  if (channel == nullptr) return {};
  std::vector<double> held_A;
  double before_A = empty_cell;
  for (const double read_A : channel->values) {
    if (!std::isnan(read_A)) before_A = std::max(0.0, read_A);
    held_A.push_back(before_A);
  }
  const auto first = std::ranges::find_if(held_A, [](double A) { return !std::isnan(A); });
  if (first == held_A.end()) return {};
  const double noise_A = 0.01 * *std::max_element(first, held_A.end());
  if (!(noise_A > 0.0)) return {};
  hold_means({first, held_A.end()}, noise_A);
  std::fill(held_A.begin(), first, *first);
  return held_A;
}

// The measured speeds of wheels, `wheel_x_rad_s` …: piecewise linear between means over blocks of
// rows. There are at most 400 blocks, because each starts a step of the propagation. Empty without
// such channels.
std::vector<WheelSpeeds> wheel_speeds(const Recording& recording) {
  const Channel* wheel[3] = {recording.find("wheel_x_rad_s"), recording.find("wheel_y_rad_s"),
                             recording.find("wheel_z_rad_s")};
  std::vector<WheelSpeeds> knots;
  if (wheel[0] == nullptr && wheel[1] == nullptr && wheel[2] == nullptr) return knots;
  constexpr size_t most_knots = 400;
  const size_t rows = recording.rows();
  const size_t together = (rows + most_knots - 1) / most_knots;
  for (size_t first = 0; first < rows; first += together) {
    const size_t last = std::min(rows, first + together);
    WheelSpeeds knot;
    for (size_t i = first; i < last; ++i) knot.from_s += recording.time_s[i];
    knot.from_s /= static_cast<double>(last - first);
    for (int k = 0; k < 3; ++k) {
      double sum = 0.0, count = 0.0;
      for (size_t i = first; wheel[k] != nullptr && i < last; ++i) {
        if (std::isnan(wheel[k]->values[i])) continue;
        sum += wheel[k]->values[i];
        count += 1.0;
      }
      // A block without a reading keeps the speed of the previous one.
      const double before = knots.empty() ? 0.0 : knots.back().speed_rad_s[k];
      knot.speed_rad_s[k] = count > 0.0 ? sum / count : before;
    }
    knots.push_back(knot);
  }
  for (size_t i = 0; i + 1 < knots.size(); ++i) {
    knots[i].acceleration_rad_s2 =
        (knots[i + 1].speed_rad_s - knots[i].speed_rad_s) / (knots[i + 1].from_s - knots[i].from_s);
  }
  return knots;
}

}  // namespace

Schedule Recording::schedule() const {
  const Channel* command[3] = {find("command_x_N_m"), find("command_y_N_m"), find("command_z_N_m")};
  const Channel* force_lab[2] = {find("command_x_N"), find("command_y_N")};
  const Channel* force_body[2] = {find("command_body_x_N"), find("command_body_y_N")};
  const Channel* current = find("battery_current_A");
  Schedule schedule;
  schedule.current_is_measured = current != nullptr;
  const std::vector<double> lamps_A = lamp_currents_A(find("led_current_A"));
  const std::vector<WheelSpeeds> knots = wheel_speeds(*this);
  size_t next = 0;
  ZeroOrderHold held;
  // Before the first knot, the speed of a wheel is on the line of its first interval.
  if (!knots.empty()) held.wheel = knots.front();
  // An empty cell keeps the previous value.
  const auto update = [](const Channel* channel, size_t row, double& value) {
    if (channel != nullptr && !std::isnan(channel->values[row])) value = channel->values[row];
  };
  for (size_t i = 0; i < rows(); ++i) {
    for (int k = 0; k < 3; ++k) update(command[k], i, held.command_body_N_m[k]);
    for (int k = 0; k < 2; ++k) {
      update(force_lab[k], i, held.force_lab_N[k]);
      update(force_body[k], i, held.force_body_N[k]);
    }
    update(current, i, held.battery_current_A);
    if (!lamps_A.empty()) {
      held.led_current_A = lamps_A[i];
      held.lamps_as_stated = 0.0;
    }
    for (; next < knots.size() && knots[next].from_s <= time_s[i]; ++next) held.wheel = knots[next];
    schedule.append(time_s[i], held);
  }
  return schedule;
}

Schedule read_command_file(const std::filesystem::path& path) {
  const Recording recording = read_recording(path, {.omit_isolated_rows = false});
  const RecordingReport& report = recording.report;
  // A recording with an attitude may have faults of its clock and is read like a recording.
  const bool has_quaternion = recording.find("q_w") != nullptr;
  if (!has_quaternion && report.backward_times + report.repeated_times > 0) {
    const int64_t line = report.backward_times == 0 ? report.first_repeated_line
                         : report.repeated_times == 0
                             ? report.first_backward_line
                             : std::min(report.first_repeated_line, report.first_backward_line);
    throw InputError({path.string(), static_cast<int>(line)}, "t_s", "times that do not rise",
                     "commands in order of time");
  }
  const bool has_command = std::ranges::any_of(
      schedule_channels, [&](const char* name) { return recording.find(name) != nullptr; });
  if (has_command) return recording.schedule();
  throw InputError({path.string(), 0}, "header", "no command",
                   "command_x_N_m, another command, or the speed of a wheel");
}

}  // namespace photorque
