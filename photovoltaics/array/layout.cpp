#include "photovoltaics/array/layout.h"

#include <algorithm>
#include <span>

#include "core/errors.h"

namespace photorque {
namespace {

class Search {
 public:
  Search(const ArrayWiring& start, const CellTables& tables, const AttitudeLights& lights,
         int64_t max_tried)
      : shape_(start),
        tables_(tables),
        lights_(lights),
        max_tried_(max_tried),
        cells_(start.cells()) {
    for (const auto& string : start.strings) {
      first_.push_back(sizes_.size());
      for (const auto& substring : string.substrings) {
        if (!std::ranges::all_of(substring.rows, &CellGroup::is_cell)) {
          throw InputError({}, "array.layout", "cells tied in parallel", "cells in series");
        }
        substring_of_.insert(substring_of_.end(), substring.rows.size(), sizes_.size());
        sizes_.push_back(substring.rows.size());
      }
    }
    first_.push_back(sizes_.size());
  }

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
          if (substring_of_[i] == substring_of_[j]) continue;
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

  using Filled = std::vector<std::vector<int>>;  // cells of each substring

  // Visits every assignment once. Each cell in turn is added to every substring with room. Of
  // several empty substrings of equal size, and of several empty equal strings, only the first one
  // is used.
  template <typename Visit>
  bool visit_assignments(Filled& filled, size_t next, const Visit& visit) {
    if (next == cells_.size()) return visit(filled);
    for (size_t b = 0; b < filled.size(); ++b) {
      if (filled[b].size() == sizes_[b] || has_equal_before(filled, b)) continue;
      filled[b].push_back(cells_[next]);
      const bool go_on = visit_assignments(filled, next + 1, visit);
      filled[b].pop_back();
      if (!go_on) return false;
    }
    return true;
  }

  bool has_equal_before(const Filled& filled, size_t substring) const {
    if (!filled[substring].empty()) return false;
    size_t own = 0;  // string
    while (first_[own + 1] <= substring) ++own;
    for (size_t c = first_[own]; c < substring; ++c) {
      if (filled[c].empty() && sizes_[c] == sizes_[substring]) return true;
    }
    const auto part = [&](const auto& of, size_t string) {
      return std::span(of).subspan(first_[string], first_[string + 1] - first_[string]);
    };
    const auto is_empty = [&](size_t string) {
      return std::ranges::all_of(part(filled, string), &std::vector<int>::empty);
    };
    for (size_t other = 0; is_empty(own) && other < own; ++other) {
      if (is_empty(other) && std::ranges::equal(part(sizes_, own), part(sizes_, other)))
        return true;
    }
    return false;
  }

  int64_t count_assignments() {
    int64_t count = 0;
    Filled filled(sizes_.size());
    visit_assignments(filled, 0, [&](const Filled&) { return ++count <= max_tried_; });
    return count;
  }

  void try_all() {
    Filled filled(sizes_.size());
    visit_assignments(filled, 0, [&](const Filled& full) {
      std::vector<int> cells;
      for (const auto& substring : full) {
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
  std::vector<size_t> sizes_;         // of all substrings, string by string
  std::vector<size_t> first_;         // first substring of each string, and the end
  std::vector<size_t> substring_of_;  // per cell
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
