// What the reader of recordings met, for people.
#include <sstream>

#include "attitude/recordings/recording.h"

namespace photorque {

std::string RecordingReport::text() const {
  std::ostringstream out;
  out << rows_read << " rows read, " << rows_kept << " kept, every " << median_interval_s << " s";
  const auto say = [&](int64_t count, const char* what) {
    if (count > 0) out << "\n" << count << " " << what;
  };
  if (jitter_s > 1e-3 * median_interval_s) out << " with a jitter of " << jitter_s << " s";
  say(malformed_rows, "rows with a wrong number of cells left out");
  say(rows_without_time, "rows without a time left out");
  say(repeated_times, "rows that repeat a time left out");
  say(backward_times, "rows out of order left out");
  say(static_cast<int64_t>(gaps.size()), "gaps");
  say(empty_cells, "empty cells");
  say(unreadable_cells, "cells that hold no number");
  say(bad_quaternions, "quaternions that are not of unit norm left out");
  say(flipped_quaternions, "sign flips of the quaternion undone");
  for (const auto& [channel, count] : outliers) {
    out << "\n" << count << " outliers in " << channel << " left out";
  }
  for (const std::string& column : absent_columns) {
    out << "\nthe column " << column << ", which [recording] names, is not in it";
  }
  return out.str();
}

}  // namespace photorque
