// Current-voltage curve of a module of equal cells in uniform light, some of which are changed.
//
// The module is one string of photovoltaics/network, in which equal cells in equal light are
// evaluated once. A cell of ideality n depends on temperature and light as
//
//   I₀(T) = I₀ (T/T₀)^(3/n) exp(E/(n k) (1/T₀ − 1/T)),   R_sh(S) = R_sh S₀/S,
//
// where E is the gap of silicon. Real modules deviate from that law: ideality and resistances also
// follow powers of light and temperature, which are nuisance parameters (Translation). Source: W.
// De Soto, S. A. Klein, W. A. Beckman, Solar Energy 80, 78 (2006), eq. 12–15, here with the
// junction voltage over n in the exponent. The open-circuit voltage then tends to the gap at T = 0
// for every n.
#pragma once

#include <vector>

#include "photovoltaics/network/curve.h"

namespace photorque {

// Deviations from the law above: R_s ∝ S^a (T/T₀)^b, n ∝ S^c (T/T₀)^d, R_sh ∝ S^(e − 1). The
// saturation current follows n so that the open-circuit voltage at S₀, T₀ is unchanged.
struct Translation {
  double series_by_light = 0.0, series_by_temperature = 0.0, ideality_by_light = 0.0,
         ideality_by_temperature = 0.0, shunt_by_light = 0.0;
};

// One cell of the module at the light and temperature of the reference.
struct ModuleCell {
  double photocurrent_A = 0.0, saturation_A = 0.0, ideality = 1.0, series_ohm = 0.0,
         shunt_ohm = 1e4, temperature_K = 298.15;
  Translation translation = {};
};

// Effects on the module.
struct ModuleState {
  double light = 1.0;  // relative to the reference
  double temperature_K = 298.15;
  double series_ohm = 0.0;  // additional, of the whole module
  double shunt_S = 0.0;     // additional, across every cell
  int bypassed = 0;         // number of cells with a shorted bypass diode
  // Reverse breakdown of a cell (J. W. Bishop 1988).
  struct Breakdown {
    double fraction = 0.0, voltage_V = -15.0, exponent = 3.0;
  };
  struct Shaded {
    int count = 0;
    double factor = 1.0;  // factor on their light
    Breakdown breakdown = {};
    bool is_bypassed = true;  // false: their bypass diode is open
    bool in_all_chains = false;
    double leak = 1.0;  // conductance of their shunt relative to that of the others
  };
  std::vector<Shaded> shaded;
  // A part of a cell's area that is connected to the rest only through a resistance.
  struct Cracked {
    int count = 0;
    double fraction = 0.0, resistance_ohm = 0.0;
    Breakdown breakdown = {};
    double leak = 1.0;  // as for shaded cells
  };
  std::vector<Cracked> cracked;
  struct Shunted {
    int count = 0;
    double shunt_S = 0.0;
  };
  std::vector<Shunted> shunted;
  // The light varies during the sweep with u = V over the largest voltage of the curve: light · (1
  // + change (u − 1/2) + bend (6u² − 6u + 1)).
  double light_change = 0.0, light_bend = 0.0;
  double bypass_drop = 1.0;  // forward drop of the bypass diodes relative to that of the wiring
};

struct ModuleWiring {
  int cells = 1;
  int bypass_every = 0;  // 0: no diodes
  double bypass_drop_V = 0.5;
  // Parallel chains of cells under each bypass diode; half-cut modules: 2. Changed cells are in one
  // of the chains, with its fraction of the area.
  int chains = 1;
};

// The curve in constant light. All changed cells of one kind are under one diode.
ArrayCurve module_curve(const ModuleWiring& wiring, const ModuleCell& cell,
                        const ModuleState& state);

// Points of the curve at rising voltages in varying light. First order: the error is within 0.1 %
// of the short-circuit current for changes of 20 %.
std::vector<ArrayCurve::SlopedPoint> module_points(const ModuleWiring& wiring,
                                                   const ModuleCell& cell, const ModuleState& state,
                                                   const std::vector<double>& voltage_V);

}  // namespace photorque
