// A StringCurve from its wiring: cells in runs, and where its diodes begin to conduct.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numerics/root.h"
#include "photovoltaics/network/string.h"

namespace photorque {

StringCurve::StringCurve(const ArrayWiring::String& wiring, const CellTables& tables,
                         const std::vector<double>& photocurrents_A, double cell_offset_V,
                         const std::function<bool(size_t)>& is_shorted)
    : blocking_(wiring.blocking), cell_offset_V_(cell_offset_V) {
  reserve(wiring);
  for (size_t s = 0; s < wiring.substrings.size(); ++s) {
    if (!is_shorted(s)) add_substring(wiring.substrings[s], tables, photocurrents_A);
  }
  for (const Substring& substring : substrings_) {
    largest_photocurrent_A_ = std::max(largest_photocurrent_A_, largest_A(substring));
  }
  StringState state = make_state();
  for (Substring& substring : substrings_) {
    const DiodeJunction& bypass = substring.bypass;
    if (bypass.kind == Diode::Kind::clamp) {
      substring.clamp_A = rows_current_A(substring, bypass.drop_V, state);
    } else if (bypass.kind == Diode::Kind::junction) {
      const double typical_A = 0.2 * largest_photocurrent_A_;
      substring.turn_on_A = rows_current_A(
          substring, bypass.scale_V * std::log1p(typical_A / bypass.saturation_A), state);
    }
    substring.open_circuit_V = rows_at(substring, 0.0, state).voltage_V;
  }
  at_current(0.0, regime_at(0.0), 1e-9, state);
  open_circuit_V_ = state.voltage_V;
}

// Room for all, filled up in runs of like tables.
void StringCurve::reserve(const ArrayWiring::String& wiring) {
  size_t cells = 0;
  for (const auto& substring : wiring.substrings) {
    for (const auto& row : substring.rows) cells += row.size();
    cells += DiodeVoltageLaw::lanes;
  }
  cells_.reserve(cells);
  photocurrents_A_.reserve(cells);
  copies_.reserve(cells);
  wired_.reserve(cells);
  first_wired_.reserve(cells);
  substrings_.reserve(wiring.substrings.size());
}

void StringCurve::add_cell(int cell, const CellTables& tables,
                           const std::vector<double>& photocurrents_A) {
  const auto i = static_cast<size_t>(cell);
  cells_.push_back({tables[i].get(), photocurrents_A[i], tables[i]->curve().parameters().series_ohm,
                    1.0, cell_offset_V_});
  photocurrents_A_.push_back(photocurrents_A[i]);
  close_V_ = std::min(close_V_, 0.1 * tables[i]->curve().min_scale_V());
  copies_.push_back(1.0);
  first_wired_.push_back(static_cast<uint32_t>(wired_.size()));
  wired_.push_back(cell);
}

// Cells of one law stand next to each other; like cells under the same light become one.
void StringCurve::add_series(std::vector<int> cells, const CellTables& tables,
                             const std::vector<double>& photocurrents_A) {
  const auto law = [&](int cell) { return tables[static_cast<size_t>(cell)].get(); };
  // In the order in which the string meets them, which no address in memory changes.
  std::vector<const DiodeVoltageLaw*> laws;
  for (const int cell : cells) {
    if (std::ranges::find(laws, law(cell)) == laws.end()) laws.push_back(law(cell));
  }
  const auto light_A = [&](int cell) { return photocurrents_A[static_cast<size_t>(cell)]; };
  std::ranges::stable_sort(cells, [&](int a, int b) {
    if (law(a) != law(b)) {
      return std::ranges::find(laws, law(a)) < std::ranges::find(laws, law(b));
    }
    return light_A(a) < light_A(b);
  });
  for (size_t first = 0, end = 0; first < cells.size(); first = end) {
    Run run{law(cells[first]), 0.0, 0.0, static_cast<uint32_t>(cells_.size()), 0, 0};
    for (; end < cells.size() && law(cells[end]) == run.law; ++end) {
      if (end > first && light_A(cells[end]) == light_A(cells[end - 1])) {
        cells_.back().copies += 1.0;
        copies_.back() += 1.0;
        wired_.push_back(cells[end]);
      } else {
        add_cell(cells[end], tables, photocurrents_A);
      }
      run.series_ohm += cells_.back().series_ohm;
      run.offset_V += cell_offset_V_;
    }
    run.cells = static_cast<uint32_t>(cells_.size()) - run.first_cell;
    while ((cells_.size() - run.first_cell) % DiodeVoltageLaw::lanes != 0) {
      add_cell(cells[end - 1], tables, photocurrents_A);
      copies_.back() = 0.0;
    }
    run.filled_cells = static_cast<uint32_t>(cells_.size()) - run.first_cell;
    runs_.push_back(run);
  }
}

void StringCurve::add_substring(const ArrayWiring::Substring& wiring, const CellTables& tables,
                                const std::vector<double>& photocurrents_A) {
  std::vector<int> singles;
  for (const auto& row : wiring.rows) {
    if (row.size() == 1) singles.push_back(row[0]);
  }
  Substring substring{DiodeJunction(wiring.bypass)};
  substring.first_run = static_cast<uint32_t>(runs_.size());
  add_series(std::move(singles), tables, photocurrents_A);
  substring.runs = static_cast<uint32_t>(runs_.size()) - substring.first_run;
  substring.first_row = static_cast<uint32_t>(rows_.size());
  for (const auto& row : wiring.rows) {
    if (row.size() == 1) continue;
    rows_.push_back({static_cast<uint32_t>(cells_.size()), static_cast<uint32_t>(row.size())});
    for (const int cell : row) add_cell(cell, tables, photocurrents_A);
  }
  substring.rows = static_cast<uint32_t>(rows_.size()) - substring.first_row;
  substrings_.push_back(substring);
}

// From this current on no row has a voltage above zero.
double StringCurve::largest_A(const Substring& substring) const {
  double largest = 0.0;
  for (const Run& run : runs_of(substring)) {
    largest = std::max(largest, cells_[run.first_cell + run.cells - 1].photocurrent_A);
  }
  for (const Row& row : rows_of(substring)) {
    double sum = 0.0;
    for (const LitCell& cell : lit(row)) sum += cell.photocurrent_A;
    largest = std::max(largest, sum);
  }
  return largest;
}

double StringCurve::rows_current_A(const Substring& substring, double drop_V,
                                   StringState& state) const {
  const auto excess_V = [&](double current_A) {
    const ElementPoint p = rows_at(substring, current_A, state);
    const double excess = p.voltage_V + drop_V;
    return FunctionAt{excess, -p.slope_ohm, p.curvature_V_A2, p.third_V_A3, close(excess)};
  };
  double low = 0.0, high = largest_A(substring), step = 1e-3 * high + 1e-9;
  while (excess_V(high).value > 0.0) {
    low = high;
    high += step;
    step *= 4.0;
  }
  return falling_root(low, high, std::midpoint(low, high), 1e-9, excess_V);
}

}  // namespace photorque
