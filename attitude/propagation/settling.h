// When a fixed-point iteration ends: converged as far as asked or as rounding allows, or failed.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace photorque {

// Judges the size of one change after the other. Changes may rise for an iteration or two even
// where the iteration converges, so one rise decides nothing.
class Settling {
 public:
  enum class Verdict { go_on, settled, failed };

  // What is left after a change shall be below `settled`; when changes below `rounding` stop
  // falling, rounding is all that is left. After `patience` changes in a row without a new smallest
  // one the iteration has failed.
  Settling(double settled, double rounding, int patience = 6)
      : settled_(settled), rounding_(rounding), patience_(patience) {}

  Verdict judge(double change) {
    if (!std::isfinite(change)) return Verdict::failed;
    const double contraction = std::min(change / previous_, 1.0);
    const double left = change * std::max(contraction, before_);
    if (change == 0.0 || left < settled_) return Verdict::settled;
    rises_ = change < best_ ? 0 : rises_ + 1;
    best_ = std::min(best_, change);
    if (rises_ >= 2 && change < rounding_) return Verdict::settled;
    if (rises_ >= patience_) return Verdict::failed;
    before_ = std::isfinite(previous_) ? contraction : 1.0;
    previous_ = change;
    return Verdict::go_on;
  }

 private:
  double settled_, rounding_;
  int patience_;
  double previous_ = std::numeric_limits<double>::infinity();
  double best_ = std::numeric_limits<double>::infinity();
  double before_ = 1.0;  // the contraction before
  int rises_ = 0;
};

}  // namespace photorque
