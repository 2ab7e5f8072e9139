// Four parallel strings at a time in vector registers: I of each at one voltage.
//
// Solves the equations of StringCurve::at_voltage() for strings that are cells of one table in
// series with one bypass diode at most, between short and open circuit.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/numerics/quad.h"
#include "photovoltaics/cell/table.h"
#include "photovoltaics/network/string.h"

namespace photorque {

class FourStrings {
 public:
  // Groups of four, the last one filled up with its own strings again; strings that fit in none are
  // left out. Keeps pointers into the strings' tables.
  static std::vector<FourStrings> groups(std::span<const StringCurve> strings);

  // Which of the strings; the first of four.
  std::span<const size_t> members() const { return std::span(member_).first(count_); }
  size_t member(size_t lane) const { return member_[lane]; }  // beyond count, again the last
  // Above its open circuit a string is blocked or fed backwards: it is not solved here, and what is
  // said below about members does not hold for it.
  bool solves(size_t lane, double voltage_V) const { return voltage_V < open_circuit_V_[lane]; }

  // All four at one voltage, as in StringState.
  struct State {
    double voltage_V = 0.0;
    Quad current_A;
    SlopesOf<Quad> resistance;
  };
  // From and to the states of all strings; those of cells and diodes are left alone.
  State read(std::span<const StringState> states) const;
  void write(const State& state, std::span<StringState> states) const;

  // Solves at a voltage, from the currents in `state`, within [low_A, high_A], exact to 1e-12;
  // false when the search does not end: `state` is then as it was. With `states`, those of all
  // strings, cells and diodes are written there, evaluated within a fraction `tolerance` of the
  // currents.
  bool solve(double voltage_V, const Quad& low_A, const Quad& high_A, double tolerance,
             State& state, std::span<StringState> states) const;
  // From a solution at a voltage not far away, without cells.
  bool advance(double voltage_V, State& state) const;
  // Sum of the currents of all members.
  double sum_A(const State& state) const;

 private:
  struct Point {  // of V(I)
    Quad voltage_V;
    SlopesOf<Quad> resistance;
    Quad bypass_S{};
  };
  // Where the states of each member's cells go; null: nowhere.
  using CellTargets = std::array<JunctionState*, 4>;

  bool fits(const PlainString& string) const;
  void add(size_t index, const StringCurve& curve, const PlainString& string);
  void fill();
  Point rows_at(const Quad& rows_A, const CellTargets& targets, bool& outside) const;
  // False where that is not found.
  bool add_bypass(Point& at, Quad& current_A, Quad& leak_A) const;
  void add_blocking(Point& at, const Quad& current_A) const;
  bool at_currents(const CellTargets& targets, Quad& current_A, Quad& leak_A, Point& at) const;
  void write_diodes(const Point& at, double voltage_V, const Quad& current_A,
                    std::span<StringState> states) const;

  std::array<size_t, 4> member_{}, cells_{};
  size_t count_ = 0;
  const DiodeVoltageTable* table_ = nullptr;
  bool bypass_junctions_ = false, blocking_junctions_ = false;
  std::vector<std::array<double, 4>> light_A_, copies_;  // cell by cell
  Quad series_ohm_{}, max_A_{}, open_circuit_V_{};
  Quad bypass_saturation_A_{}, bypass_scale_V_{}, bypass_ohm_{};
  Quad blocking_saturation_A_{}, blocking_scale_V_{}, blocking_ohm_{}, blocking_drop_V_{};
  double close_V_ = 0.0;
};

}  // namespace photorque
