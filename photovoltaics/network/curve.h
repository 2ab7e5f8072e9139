// The exact current–voltage curve of an array in given light.
//
// Between breakpoints (at which an ideal bypass or blocking diode starts to conduct) the curve is a
// smooth function. One string is V(I), explicit through the cells' tables. Several strings are
// I(V), each string solved for its current. `x` is the independent variable, `y` the other one.
//
// A resistance R may be in series with the array. For one string it adds to V(I). For several
// strings x remains the voltage before R, and the power is y (x − R y).
//
// Maxima of the power are zeros of P′ = y − (x − 2 R y)·slope (without R: P′ = y − x·slope). At a
// breakpoint the slope falls, so P′ jumps upwards and no maximum lies there. Inside a piece, bounds
// on slope and curvature over an interval follow from the diode voltages at its ends. With D‴ > 0
// (true while n V_t ≪ |V_br|) D″ is monotone, and D′ has its only minimum where D″ = 0. Sums and
// reciprocals of such bounds cover the network (elements.h). An interval is halved until the bounds
// show that P′ has no zero in it, or is monotone in it and so has at most one. This finds all local
// maxima.
#pragma once

#include <vector>

#include "photovoltaics/network/string.h"

namespace photorque {

struct ArrayPoint {
  double voltage_V = 0.0;
  double current_A = 0.0;
  double power_W() const { return voltage_V * current_A; }
};

// The states of all cells, indexed as in the wiring.
struct CellStates {
  std::vector<double> voltages_V;  // < 0: reverse-biased
  std::vector<double> currents_A;
};

class ArrayCurve {
 public:
  // `tables[i]` and `photocurrents_A[i]` (≥ 0) belong to cell i of the wiring; equal cells share a
  // law. A shunt that depends on the light is evaluated at the cell's photocurrent (in_light()).
  // Throws InputError for a wiring without cells or with an index that has no cell.
  ArrayCurve(const ArrayWiring& wiring, CellTables tables,
             const std::vector<double>& photocurrents_A, const ArrayChanges& changes = {});

  double short_circuit_A() const { return by_current() ? end_x_ : current_A(0.0); }
  double open_circuit_V() const { return by_current() ? voltage_V(0.0) : end_x_; }
  // For voltages from 0 to open circuit, and currents from 0 to short circuit.
  double current_A(double voltage_V) const;
  double voltage_V(double current_A) const;

  // All local maxima of the power between short and open circuit, by rising voltage; none in the
  // dark. The relative error of the powers is 1e-12.
  std::vector<ArrayPoint> maxima() const { return scan(1).maxima; }
  // The largest of maxima(); zero in the dark. Searches only pieces that can contain it: y falls,
  // so the power between a and b is at most y(a) b.
  ArrayPoint maximum_power() const;
  // Points of the curve by rising voltage, including both ends and all breakpoints, with at least
  // `intervals` (≥ 1) steps of x; and all local maxima.
  struct Scan {
    std::vector<ArrayPoint> points;
    std::vector<ArrayPoint> maxima;
    // Breakpoints without a maximum at which the power is nearly constant on one side: a maximum
    // has just vanished there, or appears with a small change of the light.
    std::vector<ArrayPoint> corners;
  };
  Scan scan(int intervals) const;
  CellStates cells_at(double voltage_V) const;

  // Current and −dI/dV ≥ 0 at ascending voltages of any sign, also beyond short and open circuit.
  struct SlopedPoint {
    double voltage_V = 0.0, current_A = 0.0, slope_S = 0.0;
  };
  std::vector<SlopedPoint> at_voltages(const std::vector<double>& rising_V) const;
  // Points from before short circuit to beyond open circuit, about a hundredth of the voltage or
  // current apart.
  std::vector<ArrayPoint> trace() const;
  // The point of the curve, also beyond short and open circuit, that is nearest to a reading in
  // units of its errors (> 0). For many readings the search starts from the nearest point of a
  // trace().
  SlopedPoint nearest(const ArrayPoint& reading, const ArrayPoint& error,
                      const std::vector<ArrayPoint>& trace = {}) const;

  // Derivative of the current at fixed voltage with respect to the photocurrent of each cell.
  std::vector<double> current_by_photocurrent(const ArrayPoint& at) const;
  // Derivatives of a maximum with respect to the photocurrent of each cell.
  struct MaximumMotion {
    std::vector<double> voltage_ohm, current;  // ∂V/∂I_k, ∂I/∂I_k
  };
  MaximumMotion maximum_by_photocurrent(const ArrayPoint& maximum) const;

 private:
  struct Node {
    double x = 0.0, y = 0.0, slope = 0.0, curvature = 0.0, third = 0.0;
    double series_ohm = 0.0;  // R if x is the voltage, otherwise 0
    std::vector<StringState> strings;
    void sum_strings();
    double power_W() const { return (x - series_ohm * y) * y; }
    double lever() const { return x - 2.0 * series_ohm * y; }
    double power_slope() const { return y - lever() * slope; }
    double power_curvature() const {
      return -2.0 * slope - 2.0 * series_ohm * slope * slope + lever() * curvature;
    }
    double power_third() const {
      return (3.0 + 6.0 * series_ohm * slope) * curvature + lever() * third;
    }
  };
  struct Piece {
    double low_x = 0.0, high_x = 0.0;
    std::vector<StringRegime> regimes;
  };
  class Search;
  class Probe;

  // Values of x at which a string's ideal diodes start to conduct or block.
  struct Switches {
    std::vector<double> clamp_x;  // per substring; ∞ without a clamp
    double blocked_x = 0.0;       // ∞ without a blocking clamp
  };

  bool by_current() const { return strings_.size() == 1; }
  Node make_node() const;
  // `tolerance` is that of StringCurve::at_voltage(); `low` and `high`, if given, are nodes of the
  // piece at either side of x.
  void evaluate(double x, const std::vector<StringRegime>& regimes, Node& node, double tolerance,
                const Node* low = nullptr, const Node* high = nullptr) const;
  // Bounds of the current of a string. guess_current() stores the start of the search in the node.
  struct CurrentGuess {
    double low_A, high_A;
  };
  CurrentGuess guess_current(size_t s, double x, Node& node, const Node* low,
                             const Node* high) const;
  void set_photocurrents(const std::vector<double>& photocurrents_A);
  void add_strings(const ArrayWiring& wiring, const std::vector<double>& photocurrents_A,
                   const ArrayChanges& changes);
  // Moves a node from the end of `last` to the beginning of the next piece, `piece`. Only strings
  // whose diodes switch there are evaluated again.
  void enter(const Piece& piece, const Piece& last, double tolerance, Node& node) const;
  void find_regimes(double x, std::vector<StringRegime>& regimes) const;
  std::vector<StringRegime> regimes_at(double x) const;
  Switches switches_of(const StringCurve& string) const;
  double find_end_x() const;
  Node node_at(double x) const;
  double y_at(double x) const { return node_at(x).y; }
  double x_at(double y) const;
  double x_of(const ArrayPoint& point) const;
  // Lower limit of x at which the curve is defined.
  double lowest_x() const;
  // Derivatives with respect to the photocurrent of each cell at fixed voltage: of the current, and
  // of −dI/dV.
  struct Moved {
    std::vector<double> current, slope_1_V;
  };
  Moved moved_by_photocurrents(const Node& node, const std::vector<StringRegime>& regimes) const;
  // The ends of the curve and its breakpoints, in ascending order. Pieces lie between neighbours.
  // They are created when needed, because each contains a value for every bypass diode.
  std::vector<double> edges() const;
  Piece piece(double low_x, double high_x) const;
  ArrayPoint point(double x, double y) const;

  CellTables tables_;  // the strings point into it
  std::vector<StringCurve> strings_;
  std::vector<Switches> switches_;
  size_t cells_ = 0;
  double series_ohm_ = 0.0;
  bool is_shorted_ = false;  // by a string without voltage
  double end_x_ = 0.0;       // x at y = 0
};

}  // namespace photorque
