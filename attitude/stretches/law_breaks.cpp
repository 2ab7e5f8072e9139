#include "attitude/stretches/law_breaks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text/format.h"

namespace photorque {
namespace {

// The rates about the axis that were read, each the median of five neighbours: a count that was
// lost halves a reading or two.
struct AxisRates {
  std::vector<size_t> row;
  std::vector<double> time_s, rate_rad_s;
};

AxisRates rates_about(const Observation& rows, int axis, size_t first, size_t last) {
  AxisRates read;
  for (size_t i = first; i < last; ++i) {
    if (!(rows.gyro_rows[i][axis] > 0.0)) continue;
    read.row.push_back(i);
    read.time_s.push_back(rows.time_s[i]);
    read.rate_rad_s.push_back(rows.gyro_rad_s[i][axis]);
  }
  const std::vector<double> raw = read.rate_rad_s;
  for (size_t i = 2; i + 2 < raw.size(); ++i) {
    std::array<double, 5> near = {raw[i - 2], raw[i - 1], raw[i], raw[i + 1], raw[i + 2]};
    std::nth_element(near.begin(), near.begin() + 2, near.end());
    read.rate_rad_s[i] = near[2];
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

Line line_through(const AxisRates& read, size_t first, size_t last) {
  const auto count = static_cast<double>(last - first);
  double mean_s = 0.0, mean_rad_s = 0.0;
  Line line;
  line.least_rad_s = line.most_rad_s = read.rate_rad_s[first];
  for (size_t i = first; i < last; ++i) {
    mean_s += read.time_s[i] / count;
    mean_rad_s += read.rate_rad_s[i] / count;
    line.least_rad_s = std::min(line.least_rad_s, read.rate_rad_s[i]);
    line.most_rad_s = std::max(line.most_rad_s, read.rate_rad_s[i]);
  }
  double spread_s2 = 0.0, product = 0.0, square = 0.0;
  for (size_t i = first; i < last; ++i) {
    const double t = read.time_s[i] - mean_s, w = read.rate_rad_s[i] - mean_rad_s;
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
  size_t at = 0;  // index into AxisRates
  double before_rad_s2 = 0.0, after_rad_s2 = 0.0, error_rad_s2 = 0.0;

  double change_rad_s2() const { return std::abs(after_rad_s2 - before_rad_s2); }
  double larger_rad_s2() const { return std::max(std::abs(before_rad_s2), std::abs(after_rad_s2)); }
  double standard_errors() const { return change_rad_s2() / error_rad_s2; }
};

// The slopes of `window` readings on either side of every reading where the rate goes on as before;
// of long windows at every 48th part of one, or long recordings would take the square of their
// time.
std::vector<Break> changes_of(const AxisRates& read, size_t window) {
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

// Of changes that stand out from all the others (a law that swings has them everywhere) the most
// significant of its neighbours each.
std::vector<Break> breaks_of(const AxisRates& read, size_t window) {
  constexpr double least_standard_errors = 10.0, least_share = 0.5, least_medians = 8.0;
  const std::vector<Break> changes = changes_of(read, window);
  if (changes.empty()) return {};
  std::vector<double> sizes_rad_s2;
  for (const Break& b : changes) sizes_rad_s2.push_back(b.change_rad_s2());
  const auto middle = sizes_rad_s2.begin() + static_cast<std::ptrdiff_t>(sizes_rad_s2.size() / 2);
  std::nth_element(sizes_rad_s2.begin(), middle, sizes_rad_s2.end());
  const double median_rad_s2 = *middle;
  std::vector<Break> breaks;
  for (const Break& found : changes) {
    if (found.change_rad_s2() < least_share * found.larger_rad_s2() ||
        found.change_rad_s2() < least_medians * median_rad_s2 ||
        !(found.standard_errors() >= least_standard_errors)) {  // of equal readings 0/0
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

bool is_commanded(const Schedule& schedule) {
  return std::any_of(schedule.held.begin(), schedule.held.end(),
                     [](const ZeroOrderHold& held) { return held != ZeroOrderHold{}; });
}

}  // namespace

LawfulStretch lawful_stretch(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  LawfulStretch whole = {first, last, ""};
  if (is_commanded(rows.schedule)) return whole;
  int along = 0;
  axis.cwiseAbs().maxCoeff(&along);
  const AxisRates read = rates_about(rows, along, first, last);
  std::vector<Break> breaks;
  // A long window sees a weak torque; the shortest that sees one tells best where it ends.
  for (size_t window = 12; breaks.empty() && 8 * window <= read.row.size(); window *= 2) {
    breaks = breaks_of(read, window);
  }
  if (breaks.empty()) return whole;
  LawfulStretch longest = {first, first, ""};
  size_t begin = first;
  const Break* since = nullptr;
  const auto close = [&](size_t end, const Break* until) {
    if (end - begin > longest.last - longest.first) {
      longest = {begin, end, ""};
      const Break& edge = since != nullptr ? *since : *until;
      longest.left_out = "the rate changes its slope at once at " +
                         readable_number(read.time_s[edge.at], 4) + " s, from " +
                         readable_number(edge.before_rad_s2, 3) + " to " +
                         readable_number(edge.after_rad_s2, 3) + " rad/s²: something else acts ";
      longest.left_out += since != nullptr && until != nullptr ? "before and after"
                          : since != nullptr                   ? "before"
                                                               : "after";
    }
  };
  constexpr size_t passing = 3;  // rows in which the law changes: the median of five blurs it
  for (const Break& found : breaks) {
    const size_t at = read.row[found.at];
    close(at > first + passing ? at - passing : first, &found);
    begin = std::min(last, at + passing);
    since = &found;
  }
  close(last, nullptr);
  return longest;
}

}  // namespace photorque
