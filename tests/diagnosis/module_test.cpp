// A module in sunlight: its curve against the network of photovoltaics/, and what is named in
// curves that the network made.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "diagnosis/light/module/curve.h"
#include "diagnosis/light/module/diagnose.h"
#include "photovoltaics/cell/table.h"
#include "photovoltaics/network/curve.h"

namespace photorque {
namespace {

constexpr int cells = 12;
const ModuleCell usual{5.0, 2e-9, 1.1, 0.004, 40.0, 298.15};

CellParameters parameters_of(const ModuleCell& cell, double fraction = 1.0) {
  CellParameters p;
  p.saturation_1_A = fraction * cell.saturation_A;
  p.ideality_1 = cell.ideality;
  p.series_ohm = cell.series_ohm / fraction;
  p.shunt_ohm = cell.shunt_ohm / fraction;
  p.temperature_K = cell.temperature_K;
  return p;
}

std::shared_ptr<const DiodeVoltageTable> table_of(const CellParameters& p) {
  return std::make_shared<const DiodeVoltageTable>(CellCurve(p), 40.0);
}

// All cells in one string; cell 0 may be a row of two parts.
struct Network {
  ArrayWiring wiring{{{}}};
  CellTables tables;
  std::vector<double> light_A;

  explicit Network(int bypass_every, bool split) {
    Diode bypass;
    bypass.kind = bypass_every > 0 ? Diode::Kind::clamp : Diode::Kind::none;
    const int every = bypass_every > 0 ? bypass_every : cells;
    const auto plain = table_of(parameters_of(usual));
    for (int first = 0; first < cells; first += every) {
      ArrayWiring::Substring substring{{}, bypass};
      for (int i = first; i < first + every; ++i) substring.rows.push_back({i});
      wiring.strings[0].substrings.push_back(std::move(substring));
    }
    tables.assign(cells, plain);
    light_A.assign(cells, usual.photocurrent_A);
    if (!split) return;
    wiring.strings[0].substrings[0].rows[0] = std::vector{0, cells};
    tables.push_back(plain);
    light_A.push_back(0.0);
  }
  ArrayCurve curve() const { return {wiring, tables, light_A}; }
};

void expect_like(const ArrayCurve& expected, const ModuleWiring& wiring, const ModuleState& state) {
  constexpr double tolerance_A = 1e-8;
  std::vector<double> voltage_V;
  for (int i = 0; i < 40; ++i) voltage_V.push_back(0.97 * expected.open_circuit_V() * i / 39.0);
  const auto curve = module_curve(wiring, usual, state).at_voltages(voltage_V);
  for (size_t i = 0; i < voltage_V.size(); ++i) {
    EXPECT_NEAR(curve[i].current_A, expected.current_A(voltage_V[i]), tolerance_A) << voltage_V[i];
  }
}

TEST(ModuleCurve, OfShadedCellsIsThatOfTheNetwork) {
  for (const int bypass_every : {0, 6}) {
    Network network(bypass_every, false);
    CellParameters p = parameters_of(usual);
    p.breakdown_fraction = 0.6;
    p.breakdown_V = -5.0;
    network.tables[0] = table_of(p);
    network.light_A[0] *= 0.4;
    ModuleState state;
    state.shaded = {{1, 0.4, 0.6, -5.0, 3.0}};
    expect_like(network.curve(), {cells, bypass_every, 0.5}, state);
  }
}

TEST(ModuleCurve, OfCrackedCellsIsThatOfPartsTiedInParallel) {
  Network network(0, true);
  constexpr double fraction = 0.3, resistance_ohm = 0.2;
  network.tables[0] = table_of(parameters_of(usual, 1.0 - fraction));
  CellParameters cut = parameters_of(usual, fraction);
  cut.series_ohm += resistance_ohm;
  network.tables[cells] = table_of(cut);
  network.light_A[0] = (1.0 - fraction) * usual.photocurrent_A;
  network.light_A[cells] = fraction * usual.photocurrent_A;
  ModuleState state;
  state.cracked = {{1, fraction, resistance_ohm}};
  expect_like(network.curve(), {cells, 0, 0.5}, state);
}

LightRecording measured(const ArrayCurve& curve, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 2e-3);
  LightRecording r;
  r.kind = LightRecording::Kind::sweep;
  r.name = "curve";
  for (int i = 0; i < 150; ++i) {
    const double V = curve.open_circuit_V() * i / 150.0;
    r.voltage_V.push_back(V);
    r.current_A.push_back(curve.current_A(V) + noise(random));
    r.temperature_K.push_back(298.15);
    r.lab_from_body.push_back(Quat::Identity());
    r.sweep.push_back(0);
  }
  r.rows_read = 150;
  return r;
}

ModuleDesign design_with_reference() {
  ModuleDesign design;
  design.cells = cells;
  design.references = {measured(Network(0, false).curve(), 1)};
  return design;
}

TEST(ModuleDiagnosis, NamesACellInTheShadeAndItsLight) {
  Network network(0, false);
  CellParameters p = parameters_of(usual);
  p.breakdown_fraction = 0.6;
  p.breakdown_V = -5.0;
  network.tables[3] = table_of(p);
  network.light_A[3] *= 0.55;
  const Diagnosis d = diagnose_module(design_with_reference(), {measured(network.curve(), 2)}, {});
  ASSERT_EQ(d.verdict, Verdict::missing_physics) << d.because;
  ASSERT_EQ(d.effects.front().kind, "cell_shaded");
  EXPECT_EQ(d.effects.front().parameters[0].value[0], 1.0);
  EXPECT_NEAR(d.effects.front().parameters[1].value[0], 0.55, 0.02);
  EXPECT_LT(d.holdout->rms_after.at("current_A"), 4e-3);
}

TEST(ModuleDiagnosis, NamesNothingInOtherLight) {
  Network network(0, false);
  for (double& light : network.light_A) light *= 0.8;
  // The shunt of the model follows the light; here it hardly matters.
  const Diagnosis d = diagnose_module(design_with_reference(), {measured(network.curve(), 3)}, {});
  EXPECT_EQ(d.verdict, Verdict::consistent) << d.sentence;
}

TEST(ModuleDiagnosis, NamesCellsWithAPartCutOff) {
  Network network(0, true);
  network.tables[0] = table_of(parameters_of(usual, 0.7));
  CellParameters cut = parameters_of(usual, 0.3);
  cut.series_ohm += 0.5;
  network.tables[cells] = table_of(cut);
  network.light_A[0] = 0.7 * usual.photocurrent_A;
  network.light_A[cells] = 0.3 * usual.photocurrent_A;
  const Diagnosis d = diagnose_module(design_with_reference(), {measured(network.curve(), 4)}, {});
  ASSERT_EQ(d.verdict, Verdict::missing_physics) << d.because;
  EXPECT_EQ(d.effects.front().kind, "cell_cracked");
}

}  // namespace
}  // namespace photorque
