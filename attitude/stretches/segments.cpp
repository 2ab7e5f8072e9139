#include "attitude/stretches/segments.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "attitude/readings/columns.h"
#include "attitude/stretches/law_breaks.h"
#include "core/errors.h"

namespace photorque {
namespace {

// Start and rate of an axis are two numbers, its torque one more: fewer readings say nothing of it.
constexpr size_t least_of_stretch = 6;

// Gaps over which nothing can be propagated with profit: longer than a quarter of all the time that
// was read, and than a hundred intervals. A clock that jumps makes such a gap.
double long_gap_s(const Recording& recording) {
  const RecordingReport& report = recording.report;
  double read_s = recording.time_s.back() - recording.time_s.front();
  std::vector<double> gaps_s;
  for (const RecordingReport::Gap& gap : report.gaps) gaps_s.push_back(gap.to_s - gap.from_s);
  std::sort(gaps_s.begin(), gaps_s.end());
  // The longest first: whether it is long is asked of what was read without it.
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

double median_of(std::vector<double> sizes) {
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

// The size of most of these. Between the steps of an encoder nothing changes but by rounding: of
// such readings, of those that do change.
double usual_of(const std::vector<double>& sizes) {
  constexpr double rounding = 1e-6, fewest_steps = 0.005;
  const double usual = median_of(sizes), least = rounding * std::ranges::max(sizes);
  if (usual > least) return usual;
  std::vector<double> steps;
  for (const double size : sizes) {
    if (size > least) steps.push_back(size);
  }
  const double fewest = std::max(10.0, fewest_steps * static_cast<double>(sizes.size()));
  return static_cast<double>(steps.size()) < fewest ? usual : median_of(steps);
}

// Of each the largest of the medians over so many about it, before them and after them.
std::vector<double> usual_nearby(const std::vector<double>& sizes) {
  constexpr size_t many = 32;
  const size_t stretches = std::max<size_t>(1, sizes.size() / many);
  std::vector<double> medians;
  for (size_t s = 0; s < stretches; ++s) {
    const auto first = sizes.begin() + static_cast<std::ptrdiff_t>(s * many);
    medians.push_back(median_of({first, s + 1 < stretches ? first + many : sizes.end()}));
  }
  std::vector<double> usual;
  for (size_t i = 0; i < sizes.size(); ++i) {
    const size_t at = std::min(i / many, stretches - 1);
    usual.push_back(std::max(
        {medians[at == 0 ? 0 : at - 1], medians[at], medians[std::min(at + 1, stretches - 1)]}));
  }
  return usual;
}

// Rows at which the angle about the one axis, or the path of what slides, has a kink that its own
// readings do not know: a firing that nobody noted, a wall. Noise and torques make those nearby
// alike; what has decayed later says nothing of the beginning.
std::vector<char> kinks_of(const Observation& rows, const Platform& platform) {
  std::vector<char> kinks(rows.blocks(), 0);
  const bool slides = platform.slides();
  if (slides && !(rows.has(Scalar::position_x) && rows.has(Scalar::position_y))) return kinks;
  if (!slides && (!platform.turns_about_one_axis() || !rows.sees_some_attitude())) return kinks;
  struct Change {
    size_t row;
    double rate;  // rad/s or m/s
  };
  std::vector<Change> changes;
  const auto moved = [&](size_t from, size_t to) -> Vec3 {
    if (!slides) {
      return platform.axis * platform.axis.dot(rotation_vector(rows.attitude[to] *
                                                               rows.attitude[from].conjugate()));
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
  const double usual = usual_of(sizes);
  const std::vector<double> nearby = usual_nearby(sizes);
  // Of a Gaussian, 12 of these medians are 8 standard deviations.
  constexpr double medians = 12.0;
  for (size_t i = 0; i < changes.size(); ++i) {
    kinks[changes[i].row] = changes[i].rate > medians * std::max(usual, nearby[i]) ? 1 : 0;
  }
  return kinks;
}

Segments cut(const Recording& recording, const std::string& name, const Platform& platform,
             size_t max_blocks) {
  const Observation rows = observe(recording, name, platform, std::numeric_limits<size_t>::max());
  const MotionColumns columns(recording, platform, name);
  const double gap_s = long_gap_s(recording);
  const std::vector<char> kinks = kinks_of(rows, platform);
  Segments result;
  const double share = static_cast<double>(max_blocks) / static_cast<double>(rows.blocks());
  size_t first = 0;
  const auto close = [&](size_t end) {
    size_t last = end;
    if (platform.turns_about_one_axis() && !platform.slides() && rows.has_gyro) {
      LawfulStretch lawful = lawful_stretch(rows, platform.axis, first, last);
      first = lawful.first;
      last = lawful.last;
      if (!lawful.left_out.empty()) result.lawless.push_back(std::move(lawful.left_out));
    }
    if (last > first && rows.readings(first, last) >= least_of_stretch) {
      const auto blocks = static_cast<size_t>(share * static_cast<double>(last - first));
      result.all.push_back(rows.part(first, last).averaged(std::max(least_of_stretch, blocks)));
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
                     "no stretch between events and gaps with as many as " +
                         std::to_string(least_of_stretch) + " readings",
                     "a recording with longer ones");
  }
  return result;
}

// Its angles as they are meant.
Recording read_as(const AngleConvention& angles, Recording recording) {
  recording.angle_sequence = angles.sequence;
  for (Channel& channel : recording.channels) {
    if (channel.name != "roll_rad" && channel.name != "pitch_rad" && channel.name != "yaw_rad") {
      continue;
    }
    for (double& angle : channel.values) angle *= angles.factor;
  }
  return recording;
}

}  // namespace

void refuse_jump_of_clock(const Recording& recording, const std::string& name) {
  constexpr double longest_gap = 10.0;
  double gaps_s = 0.0, longest_s = 0.0;
  RecordingReport::Gap longest;
  for (const RecordingReport::Gap& gap : recording.report.gaps) {
    const double gap_s = gap.to_s - gap.from_s;
    gaps_s += gap_s;
    if (gap_s > longest_s) longest = gap;
    longest_s = std::max(longest_s, gap_s);
  }
  if (recording.rows() < 2) return;
  const double recorded_s = recording.time_s.back() - recording.time_s.front() - gaps_s;
  if (!(longest_s > longest_gap * recorded_s)) return;
  char found[160];
  std::snprintf(found, sizeof found,
                "nothing from t_s = %.10g to %.10g, of a recording of %.4g s in all",
                longest.from_s, longest.to_s, recorded_s);
  throw InputError({name, 0}, "t_s", found,
                   "a clock that does not jump; of several stretches a file each");
}

Segments observe_segments(const Recording& recording, const std::string& name,
                          const Platform& platform, size_t max_blocks) {
  const std::optional<AngleConvention> angles = convention_of_angles(recording, platform, name);
  const bool as_usual = !angles || angles->text.empty();
  Segments result =
      cut(as_usual ? recording : read_as(*angles, recording), name, platform, max_blocks);
  if (angles) result.angles = *angles;
  return result;
}

}  // namespace photorque
