#include "photovoltaics/array/layout.h"

#include <algorithm>

#include "core/errors.h"

namespace photorque {
namespace {

struct Place {
  size_t string, substring;
};

// The wiring as a list of places, one per cell.
std::vector<Place> places_of(const ArrayWiring& wiring) {
  std::vector<Place> places;
  for (size_t s = 0; s < wiring.strings.size(); ++s) {
    for (size_t b = 0; b < wiring.strings[s].substrings.size(); ++b) {
      for (const auto& row : wiring.strings[s].substrings[b].rows) {
        if (!row.is_cell()) {
          throw InputError({}, "array.layout", "cells tied in parallel", "cells in series");
        }
        places.push_back({s, b});
      }
    }
  }
  return places;
}

class Search {
 public:
  Search(const ArrayWiring& start, const CellTables& tables, const AttitudeLights& lights,
         int64_t max_tried)
      : shape_(start),
        tables_(tables),
        lights_(lights),
        max_tried_(max_tried),
        places_(places_of(start)),
        cells_(start.cells()) {}

  LayoutResult run() {
    LayoutResult result;
    result.start_power_W = power_W(cells_);
    bound_W_ = result.bound_W = layout_bound_W(shape_, tables_, lights_);
    best_ = cells_;
    best_W_ = result.start_power_W;
    result.exact = count_assignments() <= max_tried_;
    if (result.exact) {
      try_all();
    } else {
      exchange(by_light());
      exchange(cells_);
    }
    result.wiring = wired(best_);
    result.power_W = best_W_;
    result.exact = result.exact || bound_reached();
    result.tried = tried_;
    return result;
  }

 private:
  ArrayWiring wired(const std::vector<int>& cells) const {
    ArrayWiring wiring = shape_;
    size_t next = 0;
    for (auto& string : wiring.strings) {
      for (auto& substring : string.substrings) {
        for (auto& row : substring.rows) row.cell = cells[next++];
      }
    }
    return wiring;
  }

  double power_W(const std::vector<int>& cells) {
    const ArrayWiring wiring = wired(cells);
    double sum = 0.0;
    for (const auto& light : lights_) {
      sum += ArrayCurve(wiring, tables_, light).maximum_power().power_W();
    }
    ++tried_;
    return sum / static_cast<double>(lights_.size());
  }

  void keep(const std::vector<int>& cells, double power) {
    if (power > best_W_) {
      best_W_ = power;
      best_ = cells;
    }
  }

  bool bound_reached() const { return best_W_ >= bound_W_ * (1.0 - 1e-11); }

  // Cells in order of their mean light, brightest first.
  std::vector<int> by_light() const {
    const auto light = [&](int cell) {
      double sum = 0.0;
      for (const auto& one : lights_) sum += one[static_cast<size_t>(cell)];
      return sum;
    };
    std::vector<int> order = cells_;
    std::ranges::stable_sort(order, [&](int a, int b) { return light(a) > light(b); });
    return order;
  }

  void exchange(std::vector<int> cells) {
    double power = power_W(cells);
    keep(cells, power);
    bool better = true;
    while (better) {
      better = false;
      for (size_t i = 0; i < cells.size(); ++i) {
        for (size_t j = i + 1; j < cells.size(); ++j) {
          if (together(i, j)) continue;
          if (tried_ >= max_tried_ || bound_reached()) return;
          std::swap(cells[i], cells[j]);
          const double trial = power_W(cells);
          if (trial > power * (1.0 + 1e-12)) {
            power = trial;
            better = true;
            keep(cells, power);
          } else {
            std::swap(cells[i], cells[j]);
          }
        }
      }
    }
  }

  bool together(size_t i, size_t j) const {
    return places_[i].string == places_[j].string && places_[i].substring == places_[j].substring;
  }

  // Visits every assignment once. Each cell in turn is added to every substring with room. Of
  // several empty substrings of equal size, and of several empty equal strings, only the first one
  // is used.
  template <typename Visit>
  bool visit_assignments(std::vector<std::vector<std::vector<int>>>& filled, size_t next,
                         Visit&& visit) {
    if (next == cells_.size()) return visit(filled);
    for (size_t s = 0; s < filled.size(); ++s) {
      if (string_empty(filled, s) && has_equal_string_before(filled, s)) continue;
      for (size_t b = 0; b < filled[s].size(); ++b) {
        const size_t room = shape_.strings[s].substrings[b].rows.size();
        if (filled[s][b].size() == room) continue;
        if (filled[s][b].empty() && has_equal_substring_before(filled, s, b, room)) continue;
        filled[s][b].push_back(cells_[next]);
        const bool go_on = visit_assignments(filled, next + 1, visit);
        filled[s][b].pop_back();
        if (!go_on) return false;
      }
    }
    return true;
  }

  using Filled = std::vector<std::vector<std::vector<int>>>;

  Filled nothing_filled() const {
    Filled filled;
    for (const auto& string : shape_.strings) filled.emplace_back(string.substrings.size());
    return filled;
  }
  static bool string_empty(const Filled& filled, size_t s) {
    return std::ranges::all_of(filled[s], [](const auto& substring) { return substring.empty(); });
  }
  bool same_shape(size_t a, size_t b) const {
    const auto &x = shape_.strings[a].substrings, &y = shape_.strings[b].substrings;
    return std::ranges::equal(
        x, y, [](const auto& p, const auto& q) { return p.rows.size() == q.rows.size(); });
  }
  bool has_equal_string_before(const Filled& filled, size_t s) const {
    for (size_t t = 0; t < s; ++t) {
      if (same_shape(s, t) && string_empty(filled, t)) return true;
    }
    return false;
  }
  bool has_equal_substring_before(const Filled& filled, size_t s, size_t b, size_t room) const {
    for (size_t c = 0; c < b; ++c) {
      if (filled[s][c].empty() && shape_.strings[s].substrings[c].rows.size() == room) return true;
    }
    return false;
  }

  int64_t count_assignments() {
    int64_t count = 0;
    Filled filled = nothing_filled();
    visit_assignments(filled, 0, [&](const Filled&) { return ++count <= max_tried_; });
    return count;
  }

  void try_all() {
    Filled filled = nothing_filled();
    visit_assignments(filled, 0, [&](const Filled& full) {
      std::vector<int> cells;
      for (const auto& string : full) {
        for (const auto& substring : string)
          cells.insert(cells.end(), substring.begin(), substring.end());
      }
      keep(cells, power_W(cells));
      return true;
    });
  }

  ArrayWiring shape_;
  const CellTables& tables_;
  const AttitudeLights& lights_;
  int64_t max_tried_, tried_ = 0;
  std::vector<Place> places_;
  std::vector<int> cells_, best_;
  double best_W_ = 0.0, bound_W_ = 0.0;
};

}  // namespace

LayoutResult search_layout(const ArrayWiring& start, const CellTables& tables,
                           const AttitudeLights& lights, int64_t max_tried) {
  if (lights.empty()) throw InputError({}, "array.layout", "no light", "at least one attitude");
  return Search(start, tables, lights, max_tried).run();
}

}  // namespace photorque
