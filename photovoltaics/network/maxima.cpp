// The maxima of ArrayCurve, by isolation of the zeros of P′ with bounds (curve.h).
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/numerics/root.h"
#include "photovoltaics/network/curve.h"

namespace photorque {

class ArrayCurve::Search {
 public:
  Search(const ArrayCurve& curve, int intervals) : curve_(curve), intervals_(intervals) {}

  Scan run() {
    if (curve_.end_x_ == 0.0) return {{ArrayPoint{}}, {}, {}};
    Node low = curve_.make_node(), high;
    const std::vector<double> edges = curve_.edges();
    Piece last;
    for (size_t k = 0; k + 1 < edges.size(); ++k) {
      Piece piece = curve_.piece(edges[k], edges[k + 1]);
      if (k == 0) {
        curve_.evaluate(piece.low_x, piece.regimes, low, near);
        add_point(low);
      } else {
        std::swap(low, high);
        curve_.enter(piece, last, near, low);
      }
      // Every point is the start of the solution of the next one.
      high = low;
      add_points_between(piece, high);
      curve_.evaluate(piece.high_x, piece.regimes, high, near);
      add_point(high);
      search(low, high, piece, 0);
      if (high.power_slope() >= 0.0) {
        if (k + 2 < edges.size()) add_corner(high);
      } else if (low.power_slope() <= 0.0 && k > 0) {
        add_corner(low);
      }
      last = std::move(piece);
    }
    std::ranges::sort(scan_.points, {}, &ArrayPoint::voltage_V);
    std::ranges::sort(scan_.maxima, {}, &ArrayPoint::voltage_V);
    return std::move(scan_);
  }

  // Finds only the largest maximum.
  ArrayPoint run_for_largest() {
    if (curve_.end_x_ == 0.0) return {};
    edges_ = curve_.edges();
    Node first = curve_.make_node();
    curve_.evaluate(0.0, curve_.piece(edges_[0], edges_[1]).regimes, first, near);
    search_for_largest(0, edges_.size() - 1, first);
    ArrayPoint best;
    for (const ArrayPoint& point : scan_.maxima) {
      if (point.power_W() > best.power_W()) best = point;
    }
    return best;
  }

 private:
  // Relative tolerance of the strings' currents at which their cells are evaluated: `near` for
  // bounds, `any` for points, whose currents are exact with any tolerance.
  static constexpr double near = 1e-6, any = std::numeric_limits<double>::infinity();

  struct Bounds {
    double low, high;
    bool hold_zero() const { return low <= 0.0 && high >= 0.0; }
  };

  void search(const Node& low, const Node& high, const Piece& piece, size_t depth) {
    const bool falls = low.power_slope() > 0.0 && high.power_slope() < 0.0;
    const SlopeRange range = range_between(low, high, piece);
    const Bounds second = power_curvature(low, high, range);
    if (!second.hold_zero()) {
      if (falls) refine(low, high, piece, depth);
      return;
    }
    if (!power_slope(low, high, range, second).hold_zero()) return;
    // Two zeros closer than this are not resolved in double precision.
    if (high.x - low.x <= 1e-12 * curve_.end_x_) {
      if (falls) refine(low, high, piece, depth);
      return;
    }
    Node& middle = node(depth);
    curve_.evaluate(std::midpoint(low.x, high.x), piece.regimes, middle, near, &low, &high);
    search(low, middle, piece, depth + 1);
    search(node(depth), high, piece, depth + 1);
  }

  // Margin, so that rounding does not exclude the piece of the largest maximum.
  static constexpr double enough = 1.0 - 1e-9;

  // Searches the pieces between two edges; `low` is solved at the first edge. Halves that cannot
  // exceed the largest power so far are skipped. The half with the larger bound comes first.
  void search_for_largest(size_t from, size_t to, const Node& low) {
    most_W_ = std::max(most_W_, low.power_W());
    if (to - from == 1) {
      const Piece piece = curve_.piece(edges_[from], edges_[to]);
      Node high = low;
      curve_.evaluate(piece.high_x, piece.regimes, high, near);
      search(low, high, piece, 0);
      for (const ArrayPoint& point : scan_.maxima) most_W_ = std::max(most_W_, point.power_W());
      return;
    }
    const size_t half = std::midpoint(from, to);
    Node middle = low;
    curve_.evaluate(edges_[half], curve_.piece(edges_[half], edges_[half + 1]).regimes, middle,
                    near);
    const double lower_W = low.y * edges_[half], upper_W = middle.y * edges_[to];
    const auto search_lower = [&] {
      if (lower_W >= enough * most_W_) search_for_largest(from, half, low);
    };
    most_W_ = std::max(most_W_, middle.power_W());
    if (lower_W > upper_W) search_lower();
    if (upper_W >= enough * most_W_) search_for_largest(half, to, middle);
    if (lower_W <= upper_W) search_lower();
  }

  SlopeRange range_between(const Node& low, const Node& high, const Piece& piece) const {
    if (curve_.by_current()) {
      return curve_.strings_[0].resistance_range(low.strings[0], high.strings[0], piece.regimes[0]);
    }
    SlopeRange sum;
    for (size_t s = 0; s < curve_.strings_.size(); ++s) {
      sum +=
          curve_.strings_[s].conductance_range(high.strings[s], low.strings[s], piece.regimes[s]);
    }
    return sum;
  }

  // P″ = −2 slope − 2 R slope² + lever·curvature, the lever x − 2 R y rising with x.
  static Bounds power_curvature(const Node& low, const Node& high, const SlopeRange& r) {
    const double R = low.series_ohm, from = low.lever(), to = high.lever();
    const auto fall = [&](double slope) { return -2.0 * slope - 2.0 * R * slope * slope; };
    const auto [least, most] = std::minmax({from * r.curvature_low, to * r.curvature_low,
                                            from * r.curvature_high, to * r.curvature_high});
    return {fall(r.slope_high) + least, fall(r.slope_low) + most};
  }

  // P′ = y − lever·slope: bounds from its terms and by the mean value theorem from either end.
  static Bounds power_slope(const Node& low, const Node& high, const SlopeRange& r,
                            const Bounds& second) {
    const double width = high.x - low.x;
    const double from_low = low.power_slope(), from_high = high.power_slope();
    const double from = low.lever(), to = high.lever();
    return {std::max({high.y - to * (to > 0.0 ? r.slope_high : r.slope_low),
                      from_low + std::min(0.0, width * second.low),
                      from_high - std::max(0.0, width * second.high)}),
            std::min({low.y - from * (from > 0.0 ? r.slope_low : r.slope_high),
                      from_low + std::max(0.0, width * second.high),
                      from_high - std::min(0.0, width * second.low)})};
  }

  void refine(const Node& low, const Node& high, const Piece& piece, size_t depth) {
    Node& at = node(depth);
    const double guess =
        low.x + (high.x - low.x) * low.power_slope() / (low.power_slope() - high.power_slope());
    const double x = falling_root(low.x, high.x, guess, 1e-6, [&](double trial_x) {
      curve_.evaluate(trial_x, piece.regimes, at, any, &low, &high);
      return FunctionAt{at.power_slope(), at.power_curvature(), at.power_third()};
    });
    const double h = x - at.x;  // from the last trial
    const double y = at.y - h * (at.slope - h * (at.curvature / 2 + h * at.third / 6));
    scan_.maxima.push_back(curve_.point(x, y));
  }

  // Keeps a corner if |d ln P/d ln x| is small: a change of the light by some thousandths may then
  // make it a maximum.
  void add_corner(const Node& at) {
    constexpr double nearly_level = 0.1;
    if (std::abs(at.power_slope()) * at.x > nearly_level * at.power_W()) return;
    scan_.corners.push_back(curve_.point(at.x, at.y));
  }

  void add_points_between(const Piece& piece, Node& at) {
    const double width = piece.high_x - piece.low_x;
    const int steps = std::max(1, static_cast<int>(std::ceil(intervals_ * width / curve_.end_x_)));
    for (int i = 1; i < steps; ++i) {
      curve_.evaluate(piece.low_x + width * i / steps, piece.regimes, at, any);
      add_point(at);
    }
  }

  void add_point(const Node& node) {
    scan_.points.push_back(curve_.point(node.x, node.x == curve_.end_x_ ? 0.0 : node.y));
  }

  Node& node(size_t depth) {
    while (nodes_.size() <= depth) nodes_.push_back(std::make_unique<Node>(curve_.make_node()));
    return *nodes_[depth];
  }

  const ArrayCurve& curve_;
  std::vector<std::unique_ptr<Node>> nodes_;  // one per depth: references stay valid
  int intervals_;
  Scan scan_;
  std::vector<double> edges_;
  double most_W_ = 0.0;  // at any point so far
};

ArrayCurve::Scan ArrayCurve::scan(int intervals) const {
  return Search(*this, intervals).run();
}

ArrayPoint ArrayCurve::maximum_power() const {
  return Search(*this, 1).run_for_largest();
}

}  // namespace photorque
