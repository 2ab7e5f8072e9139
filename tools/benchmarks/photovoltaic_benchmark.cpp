// Time of the solar array's curve and maxima, and of maximum power points of single cells.
//
//   photovoltaic_benchmark --benchmark_min_time=1 --benchmark_repetitions=5
//
// The relevant time is the CPU time, which depends least on other programs on the machine.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "photovoltaics/array/design.h"
#include "photovoltaics/cell/table.h"
#include "photovoltaics/network/curve.h"

namespace photorque {
namespace {

CellParameters cell() {
  for (const NamedCell& known : known_cells()) {
    if (known.name == "silicon_two_diode") return known.model.reference;
  }
  return {};
}

Diode diode(Diode::Kind kind) {
  Diode d;
  d.kind = kind;
  return d;
}

// 10 × 10 photocurrents of up to 6 A: a spot beside the centre, a gradient with ripples that make
// every cell different, or half the array in shade.
std::vector<double> light_A(const std::string& map) {
  std::vector<double> light;
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 10; ++column) {
      const double x = (column - 5.7) / 6.0, y = (row - 4.1) / 6.0;
      const double ripple = 0.02 * std::sin(2.3 * row + 1.1 * column);
      double sun = std::exp(-x * x - y * y);
      if (map == "slope") sun = 0.4 + 0.06 * row + ripple;
      if (map == "shade") sun = row < 5 ? 0.9 + ripple : 0.25 + ripple;
      light.push_back(6.0 * sun);
    }
  }
  return light;
}

// 100 cells, five substrings of 20 in one string or ten strings of ten, with real diodes
// (junctions) or ideal ones. The time contains building the network, its whole curve in 100 steps
// and all maxima. It does not contain the table of the cell type, which is independent of the
// light.
void hundred_cells(benchmark::State& state, const std::string& map, int strings, Diode::Kind kind,
                   int intervals) {
  RegularWiring options;
  options.strings = strings;
  options.bypass_every = strings == 1 ? 20 : 10;
  options.bypass = diode(kind);
  if (strings > 1) options.blocking = diode(kind);
  const ArrayWiring wiring = regular_wiring(10, 10, options);
  const CellTables tables(100, std::make_shared<const DiodeVoltageTable>(CellCurve(cell()), 20.0));
  const std::vector<double> light = light_A(map);
  size_t maxima = 0;
  for (auto _ : state) {
    const ArrayCurve curve(wiring, tables, light);
    const ArrayCurve::Scan scan = curve.scan(intervals);
    maxima = scan.maxima.size();
    benchmark::DoNotOptimize(scan.points.data());
  }
  state.counters["maxima"] = static_cast<double>(maxima);
}

void single_cell_alone(benchmark::State& state) {
  const CellCurve curve(cell());
  double light = 5.0;
  for (auto _ : state) {
    light = light > 8.0 ? 1.0 : light + 0.01;
    benchmark::DoNotOptimize(curve.maximum_power(light));
  }
}

void cell_table(benchmark::State& state) {
  const CellCurve curve(cell());
  for (auto _ : state) {
    const DiodeVoltageTable table(curve, 20.0);
    benchmark::DoNotOptimize(table.pieces());
  }
}

BENCHMARK(single_cell_alone);
BENCHMARK(cell_table);

}  // namespace

void register_arrays() {
  for (const char* map : {"spot", "slope", "shade"}) {
    for (const int strings : {1, 10}) {
      for (const auto kind : {Diode::Kind::clamp, Diode::Kind::junction}) {
        for (const int intervals : {1, 100}) {
          const std::string name = std::string("hundred_cells/") + map +
                                   (strings == 1 ? "/series" : "/parallel") +
                                   (kind == Diode::Kind::clamp ? "/ideal" : "/junction") +
                                   (intervals == 1 ? "/maxima" : "/curve_and_maxima");
          benchmark::RegisterBenchmark(name.c_str(), hundred_cells, map, strings, kind, intervals);
        }
      }
    }
  }
}

}  // namespace photorque

int main(int count, char** words) {
  photorque::register_arrays();
  benchmark::Initialize(&count, words);
  benchmark::RunSpecifiedBenchmarks();
}
