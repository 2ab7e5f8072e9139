// An array of cells as the diagnosis of light needs it: cells at any temperature, effects on single
// cells and diodes, and exact derivatives by every photocurrent.
//
// A string's voltage is an explicit function of its current,
//   V_s(I) = Σ_substrings max(Σ_cells (V_d(I_k − I) + ΔV − I R_s), −V_clamp),
// with V_d the inverse of the cell's dark current (photovoltaics/cell/cell.h, eq. 2). Strings in
// parallel are solved for their currents at one voltage. Derivatives by a photocurrent I_k follow
// implicitly: ∂V_s/∂I_k = 1/D′(V_d) where the cell's substring is not clamped, else 0.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "diagnosis/light/model/lit_cells.h"
#include "photovoltaics/network/wiring.h"

namespace photorque {

// The array under given light.
class LitNetwork {
 public:
  // `photocurrents_A` per cell, ≥ 0. InputError for junction diodes and rows of tied cells, which
  // the diagnosis does not know.
  LitNetwork(const ArrayWiring& wiring, std::shared_ptr<const LitCells> cells,
             const NetworkSettings& settings, const std::vector<double>& photocurrents_A);

  // A point of the curve with its derivatives.
  struct Point {
    double voltage_V = 0.0, current_A = 0.0;
    double slope_S = 0.0;  // −dI/dV ≥ 0 along the curve
    // ∂I/∂I_k at fixed voltage, per cell.
    std::vector<double> current_by_photocurrent;
  };
  // Places along the curve from backwards to beyond the open circuit, a hundredth of voltage and
  // current apart; where many points are asked for, the nearest is found from there.
  struct Trace {
    struct Place {
      double x, voltage_V, current_A;
    };
    std::vector<Place> places;
  };
  Trace trace() const;
  // The point nearest to a reading, distances measured in the readings' errors (> 0).
  Point nearest(double voltage_V, double current_A, double voltage_error_V, double current_error_A,
                bool derivatives, const Trace& trace = {}) const;

  // A local maximum of the power and how it moves with each photocurrent.
  struct Maximum {
    double voltage_V = 0.0, current_A = 0.0;
    std::vector<double> voltage_by_photocurrent, current_by_photocurrent;
    // No maximum, but the corner where one has just vanished, or would come up next: a little
    // other light makes it one. Without derivatives.
    bool is_corner = false;
    double power_W() const { return voltage_V * current_A; }
  };
  // Local maxima of the power, the highest first: all, the highest alone, or all with such corners
  // after them. Empty in the dark.
  enum class Which { all, highest, with_corners };
  std::vector<Maximum> maxima(Which which, bool derivatives) const;

  double short_circuit_A() const;

 private:
  static constexpr double unlimited = std::numeric_limits<double>::infinity();

  struct Substring {
    std::vector<int> cells;
    double clamp_V = 0.0;  // largest voltage backwards; infinite without a diode
    bool is_shorted = false;
  };
  struct String {
    std::vector<Substring> substrings;
    double blocking_V = 0.0;
    bool is_blocking = false;
    double largest_A = 0.0;  // photocurrent
  };
  // V(I) of a string, and which substrings are clamped.
  struct StringPoint {
    double current_A = 0.0, voltage_V = 0.0, slope_ohm = 0.0, curvature_V_A2 = 0.0;  // −V′, V″
    std::vector<char> clamped;
    std::vector<LitDiode::Point> cells;  // as wired, all substrings in turn
  };
  void evaluate(const String& string, double current_A, StringPoint& at) const;
  // The current at which a string behind a resistance has a voltage; a point that was found before
  // is where it starts.
  void solve(const String& string, double voltage_V, StringPoint& at,
             double behind_ohm = 0.0) const;
  // All strings at one voltage of the network, before the series resistance of the array.
  struct State {
    double voltage_V = 0.0, current_A = 0.0, slope_S = 0.0, curvature = 0.0;  // I, −I′, I″ by V
    std::vector<StringPoint> strings;
  };
  // `x`: the current of the only string, unless a diode blocks it; else the voltage of the network.
  void at(double x, State& state) const;
  double end_x() const;
  std::vector<double> breakpoints(double end) const;
  double clamp_current_A(const Substring& substring) const;
  double power_slope(const State& state) const;
  std::vector<double> current_derivatives(const State& state) const;
  Maximum maximum_at(const State& state, bool derivatives) const;
  // Beyond its open circuit a string behind a blocking diode has no current of its own.
  bool by_current() const { return strings_.size() == 1 && !strings_.front().is_blocking; }

  std::vector<String> strings_;
  std::shared_ptr<const LitCells> cells_;
  std::vector<double> photocurrents_A_;
  NetworkSettings settings_;
};

}  // namespace photorque
