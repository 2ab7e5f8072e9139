// A bypass or blocking diode with what its curve needs at hand.
#pragma once

#include "photovoltaics/cell/slope.h"
#include "photovoltaics/network/wiring.h"

namespace photorque {

// For a junction: with u its voltage without R_s, the current is i = I_s (e^{u/nV_t} − 1) and its
// own conductance g = (i + I_s)/nV_t. Positive forwards.
struct DiodeJunction {
  Diode::Kind kind = Diode::Kind::none;
  double drop_V = 0.0, saturation_A = 0.0, series_ohm = 0.0;
  double scale_V = 0.0, per_scale_1_V = 0.0;  // n V_t and its reciprocal

  explicit DiodeJunction(const Diode& diode);

  // At this voltage in reverse a diode carries I_s but for 1e-13 of it.
  double saturated_V() const { return -30.0 * scale_V; }
  // The voltage without R_s when the diode, R_s included, has `forward_V`. To rounding.
  double junction_V(double forward_V) const;
  double current_A(double junction_voltage_V) const;
  double conductance_S(double through_A) const {
    return (through_A + saturation_A) * per_scale_1_V;
  }

  // I(V) with the series resistance, from the junction's own conductance; V backwards, as the
  // voltage of the cells beside a bypass diode.
  Slopes slopes(double conductance_S) const;
  // Bounds between two conductances.
  SlopeRange range(double low_S, double high_S) const;

 private:
  double slope_S(double conductance_S) const;
  double curvature_A_V2(double conductance_S) const;
};

}  // namespace photorque
