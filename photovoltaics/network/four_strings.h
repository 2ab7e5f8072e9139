// Currents of four parallel strings at one voltage, in vector registers.
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
  // Groups of four; the last string of an incomplete group is repeated. Strings that fit in no
  // group are left out. Keeps pointers into the strings' tables.
  static std::vector<FourStrings> groups(std::span<const StringCurve> strings);

  // Indices of the strings of the group, at most four.
  std::span<const size_t> members() const { return std::span(member_).first(count_); }
  size_t member(size_t lane) const { return member_[lane]; }  // for further lanes the last one
  // Above its open circuit a string is blocked or has a reverse current. It is not solved here, and
  // the statements below about members do not apply to it.
  bool solves(size_t lane, double voltage_V) const { return voltage_V < open_circuit_V_[lane]; }

  // State of all four strings at one voltage, as in StringState.
  struct State {
    double voltage_V = 0.0;
    Quad current_A;
    SlopesOf<Quad> resistance;
  };
  // Reads and writes the states of the members; states of cells and diodes are unchanged.
  State read(std::span<const StringState> states) const;
  void write(const State& state, std::span<StringState> states) const;

  // Solves at a voltage, starting from the currents in `state`, within [low_A, high_A], exact to
  // 1e-12. Returns false if the search does not end; `state` is then unchanged. `states`, if not
  // empty, are those of all strings: cells and diodes are written there, evaluated within a
  // fraction `tolerance` of the currents.
  bool solve(double voltage_V, const Quad& low_A, const Quad& high_A, double tolerance,
             State& state, std::span<StringState> states) const;
  // Solves at a nearby voltage, starting from the extrapolated solution in `state`, without the
  // states of cells. Returns false if the search does not end; `state` is then unchanged.
  bool advance(double voltage_V, State& state) const;
  // Sum of the currents of all members.
  double sum_A(const State& state) const;

 private:
  struct Point {  // a point of V(I)
    Quad voltage_V;
    SlopesOf<Quad> resistance;
    Quad bypass_S{};
  };
  // Destinations of the states of each member's cells; null: none.
  using CellTargets = std::array<JunctionState*, 4>;

  bool fits(const PlainString& string) const;
  void add(size_t index, const StringCurve& curve, const PlainString& string);
  void fill();
  Point rows_at(const Quad& rows_A, const CellTargets& targets, bool& outside) const;
  // Returns false if the current is not found.
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
