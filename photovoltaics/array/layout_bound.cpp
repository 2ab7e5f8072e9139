#include "photovoltaics/array/layout.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>

namespace photorque {
namespace {

constexpr double min_drop_V = 1e-9;  // replaces a drop of zero

size_t cells_in(const ArrayWiring::String& string) {
  size_t count = 0;
  for (const auto& substring : string.substrings) count += substring.rows.size();
  return count;
}

bool of_one_kind(const ArrayWiring& shape, const CellTables& tables) {
  const std::vector<int> cells = shape.cells();
  const auto table = [&](int cell) { return tables[static_cast<size_t>(cell)].get(); };
  return std::ranges::all_of(cells, [&](int c) { return table(c) == table(cells[0]); }) &&
         std::ranges::all_of(shape.strings, [&](const auto& string) {
           return cells_in(string) == cells_in(shape.strings[0]);
         });
}

// Size of equal pieces into which all substrings can be cut, and their diode.
struct PieceShape {
  size_t size = 0;
  Diode bypass;
};

PieceShape pieces_of(const ArrayWiring& shape) {
  PieceShape piece;
  for (const auto& string : shape.strings) {
    for (const auto& substring : string.substrings) {
      piece.size = std::gcd(piece.size, substring.rows.size());
    }
  }
  double drop_V = std::numeric_limits<double>::infinity();
  for (const auto& string : shape.strings) {
    for (const auto& substring : string.substrings) {
      const size_t whole = substring.rows.size() / piece.size;
      const auto count = static_cast<double>(whole);
      if (substring.bypass.kind == Diode::Kind::clamp) {
        drop_V = std::min(drop_V, substring.bypass.drop_V / count);
      } else if (substring.bypass.kind == Diode::Kind::junction) {
        drop_V = min_drop_V;
      }
    }
  }
  if (drop_V < std::numeric_limits<double>::infinity()) {
    piece.bypass.kind = Diode::Kind::clamp;
    piece.bypass.drop_V = drop_V;
  }
  return piece;
}

// k diodes in series as one diode.
Diode times(Diode diode, double k) {
  diode.drop_V *= k;
  diode.ideality *= k;
  diode.series_ohm *= k;
  return diode;
}

// U_k as curves, k = 1 … S.
std::vector<ArrayCurve> brightest_in_series(const ArrayWiring& shape, const CellTables& tables,
                                            const std::vector<double>& light_A) {
  const PieceShape piece = pieces_of(shape);
  std::vector<int> order = shape.cells();
  std::ranges::stable_sort(order, [&](int a, int b) {
    return light_A[static_cast<size_t>(a)] > light_A[static_cast<size_t>(b)];
  });
  const size_t length = cells_in(shape.strings[0]);
  std::vector<ArrayCurve> curves;
  ArrayWiring wiring{{ArrayWiring::String{}}};
  for (size_t i = 0; i < order.size(); ++i) {
    auto& pieces = wiring.strings[0].substrings;
    if (i % piece.size == 0) pieces.push_back({{}, piece.bypass});
    pieces.back().rows.push_back({order[i]});
    if ((i + 1) % length != 0) continue;
    const size_t strings = (i + 1) / length;
    wiring.strings[0].blocking = times(shape.strings[0].blocking, static_cast<double>(strings));
    curves.emplace_back(wiring, tables, light_A);
  }
  return curves;
}

// V Σ_k U_k⁻¹(k V) between two voltages is at most the upper one times the sum at the lower one.
class SumOfCurrents {
 public:
  explicit SumOfCurrents(std::vector<ArrayCurve> curves) : curves_(std::move(curves)) {}

  double at(double voltage_V) const {
    double sum_A = 0.0, k = 0.0;
    for (const ArrayCurve& curve : curves_) {
      k += 1.0;
      if (k * voltage_V < curve.open_circuit_V()) sum_A += curve.current_A(k * voltage_V);
    }
    return sum_A;
  }

  double max_power_W() const {
    constexpr double tolerance = 1e-5;
    constexpr int max_splits = 20000, first_intervals = 64;
    struct Interval {
      double low_V, high_V, low_A;  // A at low_V
      double bound_W() const { return high_V * low_A; }
    };
    const auto below = [](const Interval& a, const Interval& b) {
      return a.bound_W() < b.bound_W();
    };
    std::priority_queue<Interval, std::vector<Interval>, decltype(below)> open(below);
    const double end_V = curves_[0].open_circuit_V();
    double found_W = 0.0;
    const auto add = [&](double low_V, double high_V, double low_A) {
      open.push({low_V, high_V, low_A});
      found_W = std::max(found_W, low_V * low_A);
    };
    for (int i = 0; i < first_intervals; ++i) {
      const double low_V = end_V * i / first_intervals;
      add(low_V, end_V * (i + 1) / first_intervals, at(low_V));
    }
    for (int split = 0; split < max_splits; ++split) {
      const Interval top = open.top();
      if (top.bound_W() <= found_W * (1.0 + tolerance)) break;
      open.pop();
      const double middle_V = std::midpoint(top.low_V, top.high_V);
      add(top.low_V, middle_V, top.low_A);
      add(middle_V, top.high_V, at(middle_V));
    }
    return open.top().bound_W();
  }

 private:
  std::vector<ArrayCurve> curves_;
};

double sorted_bound_W(const ArrayWiring& shape, const CellTables& tables,
                      const std::vector<double>& light_A) {
  const PieceShape piece = pieces_of(shape);
  std::vector<ArrayCurve> curves = brightest_in_series(shape, tables, light_A);
  // A drop of min_drop_V replaces a drop of zero. Its voltage is added again, so that the
  // bound holds.
  const size_t count = shape.cells().size() / piece.size;
  const auto pieces = static_cast<double>(count);
  const double missing_V = piece.bypass.drop_V == min_drop_V ? pieces * min_drop_V : 0.0;
  if (curves.size() == 1) {
    const ArrayPoint best = curves[0].maximum_power();
    return best.power_W() + missing_V * best.current_A;
  }
  const SumOfCurrents sum(std::move(curves));
  return sum.max_power_W() + missing_V * sum.at(0.0);
}

double bound_in_light_W(const ArrayWiring& shape, const CellTables& tables,
                        const std::vector<double>& light_A) {
  double alone_W = 0.0;
  for (const int cell : shape.cells()) {
    const auto i = static_cast<size_t>(cell);
    const auto law = law_in_light(tables[i], light_A[i]);
    alone_W += law->curve().maximum_power(light_A[i]).power_W();
  }
  if (!(alone_W > 0.0) || !of_one_kind(shape, tables)) return alone_W;
  constexpr double rounding = 1e-12;
  return std::min(alone_W, sorted_bound_W(shape, tables, light_A) * (1.0 + rounding));
}

}  // namespace

double layout_bound_W(const ArrayWiring& shape, const CellTables& tables,
                      const AttitudeLights& lights) {
  double sum_W = 0.0;
  for (const std::vector<double>& light_A : lights) {
    sum_W += bound_in_light_W(shape, tables, light_A);
  }
  return sum_W / static_cast<double>(lights.size());
}

}  // namespace photorque
