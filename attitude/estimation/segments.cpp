#include "attitude/estimation/segments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "attitude/estimation/axis_readings.h"
#include "attitude/estimation/swing.h"
#include "attitude/recordings/cleaning.h"
#include "attitude/recordings/columns.h"
#include "core/errors.h"
#include "core/numerics/median.h"
#include "core/text/format.h"

namespace photorque {

bool is_commanded(const Schedule& schedule) {
  return std::ranges::any_of(schedule.held,
                             [](const ZeroOrderHold& held) { return held != ZeroOrderHold{}; });
}

namespace {

// Initial angle, rate and torque of an axis are three numbers; fewer readings do not determine
// them.
constexpr size_t min_readings = 6;

// Shortest gap [s] at which the recording is cut. Such gaps are longer than a quarter of all
// recorded time and longer than a hundred intervals, so that a propagation over them is useless. A
// clock that jumps makes such a gap. Infinity if there is none.
double long_gap_s(const Recording& recording) {
  const RecordingReport& report = recording.report;
  double read_s = recording.time_s.back() - recording.time_s.front();
  std::vector<double> gaps_s;
  for (const RecordingReport::Gap& gap : report.gaps) gaps_s.push_back(gap.to_s - gap.from_s);
  std::sort(gaps_s.begin(), gaps_s.end());
  // Starts with the longest gap, whose length is compared with the recorded time without it.
  double longest_s = std::numeric_limits<double>::infinity();
  while (!gaps_s.empty()) {
    const double gap_s = gaps_s.back();
    if (gap_s < 0.25 * (read_s - gap_s) || gap_s < 100.0 * report.median_interval_s) break;
    longest_s = gap_s;
    read_s -= gap_s;
    gaps_s.pop_back();
  }
  return longest_s;
}

// Typical size of the changes: the median. Between the steps of an encoder, readings change only by
// rounding. If most changes are so small, it is the median of the others.
double typical_size(const std::vector<double>& sizes) {
  constexpr double rounding = 1e-6, fewest_steps = 0.005;
  const double usual = upper_median(sizes), least = rounding * std::ranges::max(sizes);
  if (usual > least) return usual;
  std::vector<double> steps;
  for (const double size : sizes) {
    if (size > least) steps.push_back(size);
  }
  const double fewest = std::max(10.0, fewest_steps * static_cast<double>(sizes.size()));
  return static_cast<double>(steps.size()) < fewest ? usual : upper_median(steps);
}

// Threshold for each reading: a larger change of the rate is a kink. It is at least 12 medians of
// the sizes nearby, which are 8 standard deviations of Gaussian readings. Most readings of an
// encoder change by less than its step, some by one or two steps. Therefore it is also at least 2.5
// times the 90th percentile of the sizes nearby.
std::vector<double> kink_threshold(const std::vector<double>& sizes) {
  constexpr size_t group = 32;
  constexpr double medians = 12.0, most = 0.9, steps = 2.5;
  const size_t groups = std::max<size_t>(1, sizes.size() / group);
  std::vector<double> of_group;
  for (size_t s = 0; s < groups; ++s) {
    const auto first = sizes.begin() + static_cast<std::ptrdiff_t>(s * group);
    std::vector<double> near(first, s + 1 < groups ? first + group : sizes.end());
    std::ranges::sort(near);
    const auto large = static_cast<size_t>(most * static_cast<double>(near.size()));
    of_group.push_back(std::max(medians * near[near.size() / 2], steps * near[large]));
  }
  const double least = medians * typical_size(sizes);
  std::vector<double> threshold;
  for (size_t i = 0; i < sizes.size(); ++i) {
    const size_t at = std::min(i / group, groups - 1);
    threshold.push_back(std::max({least, of_group[at == 0 ? 0 : at - 1], of_group[at],
                                  of_group[std::min(at + 1, groups - 1)]}));
  }
  return threshold;
}

// Marks rows at which the angle about the only axis, or the path of a sliding body, has a kink
// without a recorded event, for example by an unrecorded firing or a wall. The threshold follows
// from the readings nearby, because the late, decayed motion does not represent the beginning.
std::vector<char> kinks_of(const Observation& rows, const Platform& platform) {
  std::vector<char> kinks(rows.blocks(), 0);
  const bool slides = platform.slides();
  if (slides && !(rows.has(Scalar::position_x) && rows.has(Scalar::position_y))) return kinks;
  if (!slides && (!platform.turns_about_one_axis() || !rows.has_some_attitude())) return kinks;
  struct Change {
    size_t row;
    double rate;  // rad/s or m/s
  };
  std::vector<Change> changes;
  const auto moved = [&](size_t from, size_t to) -> Vec3 {
    if (!slides) {
      return platform.axis *
             platform.axis.dot(turn_vector(rows.attitude[to] * rows.attitude[from].conjugate()));
    }
    Vec3 by = Vec3::Zero();
    for (int k = 0; k < 2; ++k) {
      const std::vector<double>& x =
          rows.scalar[static_cast<size_t>(Scalar::position_x) + static_cast<size_t>(k)].value;
      by[k] = x[to] - x[from];
    }
    return by;
  };
  const auto is_read = [&](size_t i) {
    if (!slides) return rows.attitude_rows[i] > 0.0;
    return rows.rows_of(i, vector_channels + static_cast<int>(Scalar::position_x)) > 0.0 &&
           rows.rows_of(i, vector_channels + static_cast<int>(Scalar::position_y)) > 0.0;
  };
  for (size_t i = 1; i + 1 < rows.blocks(); ++i) {
    if (!is_read(i - 1) || !is_read(i) || !is_read(i + 1)) continue;
    const Vec3 before = moved(i - 1, i) / (rows.time_s[i] - rows.time_s[i - 1]),
               after = moved(i, i + 1) / (rows.time_s[i + 1] - rows.time_s[i]);
    changes.push_back({i, (after - before).norm()});
  }
  if (changes.empty()) return kinks;
  std::vector<double> sizes;
  for (const Change& change : changes) sizes.push_back(change.rate);
  const std::vector<double> threshold = kink_threshold(sizes);
  for (size_t i = 0; i < changes.size(); ++i) {
    kinks[changes[i].row] = changes[i].rate > threshold[i] ? 1 : 0;
  }
  return kinks;
}

// Rates, each replaced by the median of five neighbours: a lost count of an encoder halves one or
// two readings.
AxisReadings smoothed_rates(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  AxisReadings read = rates_about(rows, axis, first, last);
  const std::vector<double> raw = read.value;
  for (size_t i = 2; i + 2 < raw.size(); ++i) {
    std::array<double, 5> near = {raw[i - 2], raw[i - 1], raw[i], raw[i + 1], raw[i + 2]};
    std::nth_element(near.begin(), near.begin() + 2, near.end());
    read.value[i] = near[2];
  }
  return read;
}

// A straight line through the rates [first, last).
struct Line {
  double slope_rad_s2 = 0.0, error_rad_s2 = 0.0, least_rad_s = 0.0, most_rad_s = 0.0;

  bool keeps_away_from_zero() const {
    const double far = std::max(std::abs(least_rad_s), std::abs(most_rad_s));
    return least_rad_s * most_rad_s > 0.0 &&
           std::min(std::abs(least_rad_s), std::abs(most_rad_s)) > 0.05 * far;
  }
};

Line line_through(const AxisReadings& read, size_t first, size_t last) {
  const auto count = static_cast<double>(last - first);
  double mean_s = 0.0, mean_rad_s = 0.0;
  Line line;
  line.least_rad_s = line.most_rad_s = read.value[first];
  for (size_t i = first; i < last; ++i) {
    mean_s += read.time_s[i] / count;
    mean_rad_s += read.value[i] / count;
    line.least_rad_s = std::min(line.least_rad_s, read.value[i]);
    line.most_rad_s = std::max(line.most_rad_s, read.value[i]);
  }
  double spread_s2 = 0.0, product = 0.0, square = 0.0;
  for (size_t i = first; i < last; ++i) {
    const double t = read.time_s[i] - mean_s, w = read.value[i] - mean_rad_s;
    spread_s2 += t * t;
    product += t * w;
    square += w * w;
  }
  line.slope_rad_s2 = product / spread_s2;
  const double rest = std::max(0.0, square - line.slope_rad_s2 * product) / (count - 2.0);
  line.error_rad_s2 = std::sqrt(rest / spread_s2);
  return line;
}

struct Break {
  size_t at = 0;  // index into the readings
  double before_rad_s2 = 0.0, after_rad_s2 = 0.0, error_rad_s2 = 0.0;

  double change_rad_s2() const { return std::abs(after_rad_s2 - before_rad_s2); }
  double larger_rad_s2() const { return std::max(std::abs(before_rad_s2), std::abs(after_rad_s2)); }
  double standard_errors() const { return change_rad_s2() / error_rad_s2; }
};

// Slopes of `window` readings on both sides of every reading at which the rate keeps its sign and
// is not near zero, where dry friction causes breaks. For long windows only every (window/48)-th
// reading is used; the time would otherwise grow with the square of the length.
std::vector<Break> changes_of(const AxisReadings& read, size_t window) {
  std::vector<Break> changes;
  const size_t step = std::max<size_t>(1, window / 48);
  for (size_t i = window; i + window <= read.row.size(); i += step) {
    const Line before = line_through(read, i - window, i),
               after = line_through(read, i, i + window);
    const bool goes_on = before.keeps_away_from_zero() && after.keeps_away_from_zero() &&
                         before.most_rad_s * after.most_rad_s > 0.0;
    if (!goes_on) continue;
    changes.push_back({i, before.slope_rad_s2, after.slope_rad_s2,
                       std::hypot(before.error_rad_s2, after.error_rad_s2)});
  }
  return changes;
}

// The changes of slope that are much larger than all others. Among neighbouring changes, only the
// most significant is kept. An oscillating law has such changes everywhere and therefore no breaks.
std::vector<Break> breaks_of(const AxisReadings& read, size_t window) {
  constexpr double least_standard_errors = 10.0, least_fraction = 0.5, least_medians = 8.0;
  const std::vector<Break> changes = changes_of(read, window);
  if (changes.empty()) return {};
  std::vector<double> sizes_rad_s2;
  for (const Break& b : changes) sizes_rad_s2.push_back(b.change_rad_s2());
  const double median_rad_s2 = upper_median(std::move(sizes_rad_s2));
  std::vector<Break> breaks;
  for (const Break& found : changes) {
    if (found.change_rad_s2() < least_fraction * found.larger_rad_s2() ||
        found.change_rad_s2() < least_medians * median_rad_s2 ||
        !(found.standard_errors() >= least_standard_errors)) {  // 0/0 for equal readings
      continue;
    }
    if (breaks.empty() || found.at - breaks.back().at > window) {
      breaks.push_back(found);
    } else if (found.standard_errors() > breaks.back().standard_errors()) {
      breaks.back() = found;
    }
  }
  return breaks;
}

// Rows [first, last) in which the rate about one axis follows one law.
struct ConsistentSegment {
  size_t first = 0, last = 0;
  std::string left_out;  // the reason for leaving out the rest; empty: nothing is left out
};

// The longest part of the rows [first, last) without a change of the law, for example by a drive
// that is released or a hand that brakes. A torque that depends on angle and rate cannot change the
// slope of the rate suddenly while angle and rate are continuous. All rows are returned if commands
// or measured wheels act, or if a weight exerts a torque once per turn.
ConsistentSegment consistent_segment(const Observation& rows, const Vec3& axis, size_t first,
                                     size_t last) {
  ConsistentSegment whole = {first, last, ""};
  if (is_commanded(rows.schedule) || !angles_over_weight(rows, axis).row.empty()) return whole;
  const AxisReadings read = smoothed_rates(rows, axis, first, last);
  std::vector<Break> breaks;
  // A long window detects a weak torque. The shortest window that detects a break locates it best.
  for (size_t window = 12; breaks.empty() && 8 * window <= read.row.size(); window *= 2) {
    breaks = breaks_of(read, window);
  }
  if (breaks.empty()) return whole;
  ConsistentSegment longest = {first, first, ""};
  size_t begin = first;
  const Break* since = nullptr;
  const auto close = [&](size_t end, const Break* until) {
    if (end - begin > longest.last - longest.first) {
      longest = {begin, end, ""};
      const Break& edge = since != nullptr ? *since : *until;
      longest.left_out = "the angular acceleration changes suddenly at " +
                         readable_number(read.time_s[edge.at], 4) + " s, from " +
                         readable_number(edge.before_rad_s2, 3) + " to " +
                         readable_number(edge.after_rad_s2, 3) + " rad/s²: another torque acts ";
      longest.left_out += since != nullptr && until != nullptr ? "before and after"
                          : since != nullptr                   ? "before"
                                                               : "after";
    }
  };
  constexpr size_t passing = 3;  // rows that the median of five blurs around a break
  for (const Break& found : breaks) {
    const size_t at = read.row[found.at];
    close(at > first + passing ? at - passing : first, &found);
    begin = std::min(last, at + passing);
    since = &found;
  }
  close(last, nullptr);
  return longest;
}

// Rows from `first` to before `last` in which the rotation about the only axis follows one law. The
// reasons for leaving out the others are added to `exclusions`.
std::pair<size_t, size_t> rows_of_one_law(const Observation& rows, const Vec3& axis, size_t first,
                                          size_t last, std::vector<std::string>& exclusions) {
  const auto start_at = [&](size_t row, const std::string& reason) {
    if (row > first) {
      exclusions.push_back("until " + readable_number(rows.time_s[row], 4) + " s " + reason);
    }
    first = row;
  };
  const bool is_driven = is_commanded(rows.schedule);
  if (!is_driven) {
    start_at(start_of_motion(rows, axis, first, last),
             "the body is at rest and then starts suddenly (a drive or a hand)");
  }
  if (rows.has_gyro) {
    ConsistentSegment lawful = consistent_segment(rows, axis, first, last);
    first = lawful.first;
    last = lawful.last;
    if (!lawful.left_out.empty()) exclusions.push_back(std::move(lawful.left_out));
  }
  if (rows.has_some_attitude() && !is_driven) {
    start_at(released_at(rows, axis, first, last),
             "the angle does not follow the law of the remaining recording (for example, a hand "
             "holds it)");
  }
  return {first, last};
}

Segments cut(const Recording& recording, const std::string& name, const Platform& platform,
             size_t max_blocks) {
  Observation rows = observe(recording, name, platform, std::numeric_limits<size_t>::max());
  const MotionColumns columns(recording, platform, name);
  const double gap_s = long_gap_s(recording);
  const std::vector<char> kinks = kinks_of(rows, platform);
  Segments result;
  const bool turns_alone = platform.turns_about_one_axis() && !platform.slides();
  if (turns_alone && is_rate_of_angle(rows, platform.axis)) {
    drop_rates(rows);
    result.notes.emplace_back(
        "the rate is the difference of neighbouring angles: it contains nothing new and is left "
        "out");
  }
  const double blocks_per_row =
      static_cast<double>(max_blocks) / static_cast<double>(rows.blocks());
  // The angles are counted once, not from the first row for each segment.
  const bool counts_turns = rows.first_angle_rad.has_value();
  const std::vector<double> angles_rad =
      counts_turns ? rows.angles_rad(platform.axis, 0, rows.blocks()) : std::vector<double>();
  rows.first_angle_rad.reset();
  size_t first = 0;
  const auto close = [&](size_t end) {
    if (end == first) return;
    size_t last = end;
    if (turns_alone) {
      std::tie(first, last) = rows_of_one_law(rows, platform.axis, first, end, result.exclusions);
    }
    if (last > first && rows.readings(first, last) >= min_readings) {
      const auto blocks = static_cast<size_t>(blocks_per_row * static_cast<double>(last - first));
      Observation segment = rows.part(first, last);
      for (size_t i = first; i < last && counts_turns && !segment.first_angle_rad; ++i) {
        if (!std::isnan(angles_rad[i])) segment.first_angle_rad = angles_rad[i];
      }
      result.all.push_back(segment.averaged(std::max(min_readings, blocks)));
    } else {
      result.too_short += last > first ? 1 : 0;
    }
    first = end;
  };
  for (size_t i = 0; i < rows.blocks(); ++i) {
    if (i > 0 && recording.time_s[i] - recording.time_s[i - 1] >= gap_s) {
      ++result.long_gaps;
      close(i);
    }
    if (!columns.has_event(i) && kinks[i] == 0) continue;
    (columns.has_event(i) ? result.events : result.kinks) += 1;
    close(i);
    first = i + 1;
  }
  close(rows.blocks());
  if (result.all.empty()) {
    throw InputError({name, 0}, "t_s",
                     "no segment between events and gaps with as many as " +
                         std::to_string(min_readings) + " readings",
                     "a recording with longer ones");
  }
  return result;
}

// The recording with zeros for the missing coordinate of a body that slides along a line. Empty if
// the recording has both coordinates or none.
std::optional<Recording> on_a_line(const Recording& recording, const Platform& platform) {
  if (!platform.slides()) return std::nullopt;
  const bool has_x = recording.find("x_m") != nullptr, has_y = recording.find("y_m") != nullptr;
  if (has_x == has_y || recording.find(has_x ? "velocity_y_m_s" : "velocity_x_m_s") != nullptr) {
    return std::nullopt;
  }
  Recording with_both = recording;
  with_both.channels.push_back({has_x ? "y_m" : "x_m", std::vector<double>(recording.rows(), 0.0)});
  return with_both;
}

}  // namespace

void refuse_jump_of_clock(const Recording& recording, const std::string& name) {
  const std::optional<ClockJump> jump = jump_of_clock(recording);
  if (!jump) return;
  throw InputError({name, 0}, "t_s",
                   printed("nothing from t_s = %.10g to %.10g, of a recording of %.4g s in all",
                           jump->gap.from_s, jump->gap.to_s, jump->recorded_s),
                   "a clock that does not jump; with several segments a file each");
}

Segments observe_segments(const Recording& recording, const std::string& name,
                          const Platform& platform, size_t max_blocks) {
  const std::optional<AngleConvention> angles = convention_of_angles(recording, platform, name);
  const bool as_usual = !angles || angles->text.empty();
  const std::optional<Recording> rates = with_rates_of_far_turns(recording, platform);
  const std::optional<Recording> along = on_a_line(recording, platform);
  Segments result = cut(rates      ? *rates
                        : along    ? *along
                        : as_usual ? recording
                                   : read_as(*angles, recording),
                        name, platform, max_blocks);
  if (rates) {
    result.notes.emplace_back(
        "the angle has fewer than nine readings a turn: it is read as the mean rates between them");
  }
  if (angles) result.angles = *angles;
  return result;
}

}  // namespace photorque
