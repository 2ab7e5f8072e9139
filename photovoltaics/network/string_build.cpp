// Construction of a StringCurve from its wiring: cells in runs, and the currents at which its
// diodes start to conduct.
#include <algorithm>
#include <cmath>

#include "core/numerics/root.h"
#include "photovoltaics/network/string.h"

namespace photorque {

StringCurve::StringCurve(const ArrayWiring::String& wiring, const CellTables& tables,
                         const std::vector<double>& photocurrents_A, double cell_offset_V,
                         const std::function<bool(size_t)>& is_shorted)
    : blocking_(wiring.blocking), cell_offset_V_(cell_offset_V) {
  reserve(wiring);
  const Source source{tables, photocurrents_A};
  std::vector<const ArrayWiring::Substring*> substrings;
  for (size_t s = 0; s < wiring.substrings.size(); ++s) {
    if (is_shorted(s)) continue;
    substrings.push_back(&wiring.substrings[s]);
    parts_.push_back({DiodeJunction(wiring.substrings[s].bypass)});
  }
  substrings_ = static_cast<uint32_t>(substrings.size());
  for (uint32_t s = 0; s < substrings_; ++s) fill_part(s, substrings[s]->rows, source);
  StringState state = make_state();
  // A part precedes those inside it.
  for (size_t k = parts_.size(); k-- > 0;) prepare_part(static_cast<uint32_t>(k), state);
  for (uint32_t s = 0; s < substrings_; ++s) {
    largest_photocurrent_A_ = std::max(largest_photocurrent_A_, parts_[s].largest_A);
  }
  for (uint32_t k = 0; k < parts_.size(); ++k) find_clamp(k, state);
  at_current(0.0, regime_at(0.0), 1e-9, state);
  open_circuit_V_ = state.voltage_V;
}

// Reserves memory for all cells, with padding for runs of equal tables.
void StringCurve::reserve(const ArrayWiring::String& wiring) {
  size_t cells = wiring.substrings.size() * DiodeVoltageLaw::lanes;
  wiring.for_each_cell([&](int) { ++cells; });
  cells_.reserve(cells);
  photocurrents_A_.reserve(cells);
  copies_.reserve(cells);
  wired_.reserve(cells);
  first_wired_.reserve(cells);
  parts_.reserve(wiring.substrings.size());
}

void StringCurve::add_cell(int cell, const Source& source) {
  const auto i = static_cast<size_t>(cell);
  const DiodeVoltageLaw* law = source.tables[i].get();
  cells_.push_back(
      {law, source.photocurrents_A[i], law->curve().parameters().series_ohm, 1.0, cell_offset_V_});
  photocurrents_A_.push_back(source.photocurrents_A[i]);
  close_V_ = std::min(close_V_, 0.1 * law->curve().min_scale_V());
  copies_.push_back(1.0);
  first_wired_.push_back(static_cast<uint32_t>(wired_.size()));
  wired_.push_back(cell);
}

// Groups the cells of one law. Equal cells in equal light become one cell with several copies.
void StringCurve::add_series(std::vector<int> cells, const Source& source) {
  const auto law = [&](int cell) { return source.tables[static_cast<size_t>(cell)].get(); };
  // Laws in the order of their first cells in the string, which is independent of addresses.
  std::vector<const DiodeVoltageLaw*> laws;
  for (const int cell : cells) {
    if (std::ranges::find(laws, law(cell)) == laws.end()) laws.push_back(law(cell));
  }
  const auto light_A = [&](int cell) { return source.photocurrents_A[static_cast<size_t>(cell)]; };
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
        add_cell(cells[end], source);
      }
      run.series_ohm += cells_.back().series_ohm;
      run.offset_V += cell_offset_V_;
    }
    run.cells = static_cast<uint32_t>(cells_.size()) - run.first_cell;
    while ((cells_.size() - run.first_cell) % DiodeVoltageLaw::lanes != 0) {
      add_cell(cells[end - 1], source);
      copies_.back() = 0.0;
    }
    run.filled_cells = static_cast<uint32_t>(cells_.size()) - run.first_cell;
    runs_.push_back(run);
  }
}

// A member without a diode that is joined like its part is dissolved: its members become members of
// the part.
void StringCurve::fill_part(uint32_t index, const std::vector<CellGroup>& members,
                            const Source& source) {
  const CellGroup::Join join =
      parts_[index].in_parallel ? CellGroup::Join::parallel : CellGroup::Join::series;
  std::vector<int> cells;
  std::vector<const CellGroup*> groups;
  const std::function<void(const CellGroup&)> gather = [&](const CellGroup& member) {
    if (member.is_cell()) {
      cells.push_back(member.cell);
    } else if (member.bypass.kind == Diode::Kind::none &&
               (member.join == join || member.parts.size() == 1)) {
      for (const CellGroup& part : member.parts) gather(part);
    } else {
      groups.push_back(&member);
    }
  };
  for (const CellGroup& member : members) gather(member);
  if (join == CellGroup::Join::parallel) {
    parts_[index].first_cell = static_cast<uint32_t>(cells_.size());
    parts_[index].cells = static_cast<uint32_t>(cells.size());
    for (const int cell : cells) add_cell(cell, source);
  } else {
    parts_[index].first_run = static_cast<uint32_t>(runs_.size());
    add_series(std::move(cells), source);
    parts_[index].runs = static_cast<uint32_t>(runs_.size()) - parts_[index].first_run;
  }
  std::vector<uint32_t> inside;
  for (const CellGroup* group : groups) {
    const auto place = static_cast<uint32_t>(parts_.size());
    inside.push_back(place);
    Part& part = parts_.emplace_back(Part{DiodeJunction(group->bypass)});
    part.in_parallel = group->join == CellGroup::Join::parallel;
    part.parent = index;
    fill_part(place, group->parts, source);
  }
  parts_[index].first_part = static_cast<uint32_t>(inner_.size());
  parts_[index].parts = static_cast<uint32_t>(inside.size());
  inner_.insert(inner_.end(), inside.begin(), inside.end());
}

// Prepares the limits and clamps of a part. The parts inside it must be prepared already.
void StringCurve::prepare_part(uint32_t index, StringState& state) {
  Part& part = parts_[index];
  for (const uint32_t p : inner(part)) {
    part.has_clamps =
        part.has_clamps || parts_[p].has_clamps || parts_[p].bypass.kind == Diode::Kind::clamp;
  }
  if (part.in_parallel) {
    for (const LitCell& cell : tied_cells(part)) part.largest_A += cell.photocurrent_A;
    part.light_A = part.largest_A;
    for (const uint32_t p : inner(part)) {
      part.largest_A += parts_[p].largest_A;
      part.light_A += parts_[p].light_A;
    }
    uint32_t holding = nothing;
    for (const uint32_t p : inner(part)) {
      if (parts_[p].lowest_V > part.lowest_V) {
        holding = p;
        part.lowest_V = parts_[p].lowest_V;
      }
    }
    if (holding != nothing) {
      part.lowest_A =
          parts_[holding].lowest_A + tied_A(index, part.lowest_V, nullptr, holding, nullptr, state);
    }
  } else {
    part.light_A = unlimited;
    for (const Run& run : runs_of(part)) {
      part.largest_A =
          std::max(part.largest_A, cells_[run.first_cell + run.cells - 1].photocurrent_A);
      part.light_A = std::min(part.light_A, cells_[run.first_cell].photocurrent_A);
    }
    double lowest_V = part.runs == 0 ? 0.0 : -unlimited, lowest_A = 0.0;
    for (const uint32_t p : inner(part)) {
      part.largest_A = std::max(part.largest_A, parts_[p].largest_A);
      part.light_A = std::min(part.light_A, parts_[p].light_A);
      lowest_V += parts_[p].lowest_V;
      lowest_A = std::max(lowest_A, parts_[p].lowest_A);
    }
    if (lowest_V > -unlimited) {
      part.lowest_V = lowest_V;
      part.lowest_A = lowest_A;
    }
  }
  part.open_circuit_V = inside_at(index, 0.0, nullptr, 1e-9, state).voltage_V;
  const DiodeJunction& bypass = part.bypass;
  if (bypass.kind == Diode::Kind::junction) {
    const double typical_A = 0.2 * part.largest_A;
    const double drop_V = bypass.scale_V * std::log1p(typical_A / bypass.saturation_A);
    if (part.lowest_V < -drop_V) part.turn_on_A = inside_A(index, drop_V, state);
    part.lowest_V = -unlimited;
    part.lowest_A = unlimited;
  } else if (bypass.kind == Diode::Kind::clamp && part.lowest_V < -bypass.drop_V) {
    part.own_clamp_A = inside_A(index, bypass.drop_V, state);
    part.lowest_V = -bypass.drop_V;
    part.lowest_A = part.own_clamp_A;
  }
}

// Converts the current of the part at which its diode starts to conduct into the current of the
// string, through the parts that contain it, from the inside to the outside.
void StringCurve::find_clamp(uint32_t index, StringState& state) {
  double current_A = parts_[index].own_clamp_A;
  uint32_t below = index;
  for (uint32_t p = parts_[index].parent; p != nothing && current_A < unlimited;
       below = p, p = parts_[p].parent) {
    const Part& part = parts_[p];
    double inside_V = 0.0;
    if (part.in_parallel) {
      inside_V = part_at(below, current_A, nullptr, 1e-9, state).voltage_V;
      for (const uint32_t other : inner(part)) {
        constexpr double same_V = 1e-9;
        if (parts_[other].lowest_V > inside_V + same_V) current_A = unlimited;
      }
      if (current_A < unlimited) {
        current_A += tied_A(p, inside_V, nullptr, below, nullptr, state);
      }
    }
    if (part.bypass.kind == Diode::Kind::clamp && current_A >= part.own_clamp_A) {
      current_A = unlimited;
    }
    if (part.bypass.kind == Diode::Kind::junction && current_A < unlimited) {
      if (!part.in_parallel) inside_V = inside_at(p, current_A, nullptr, 1e-9, state).voltage_V;
      current_A += part.bypass.current_A(part.bypass.junction_V(-inside_V));
    }
  }
  parts_[index].clamp_A = current_A;
}

}  // namespace photorque
