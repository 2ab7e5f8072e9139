// Modules as libraries and makers list them: rows of the CEC library of SAM, PAN files of PVsyst.
#pragma once

#include <string>
#include <string_view>

#include "photovoltaics/fit/fit.h"

namespace photorque {

// A module, the circuit of one of its cells, and its ratings.
struct ListedModule {
  std::string name;
  int cells_in_series = 1;
  int strings = 1;       // of cells, in parallel
  double area_m2 = 0.0;  // of the module; 0: not stated
  CellModel cell;        // for the cell's share of that area, or of 1 m² where it is not stated
  double photocurrent_A = 0.0;  // of a cell in the light of `rated`
  RatedPoint rated;

  // Figures of the circuit of all cells; the photocurrent is proportional to the light.
  RatedPoint predict(double irradiance_W_m2, double temperature_K) const;
};

// The module that a text describes; messages call it `file`.
//
// A table with the columns A_c, N_s, alpha_sc, a_ref, I_L_ref, I_o_ref, R_s, R_sh_ref and Adjust is
// a library of SAM; `name` selects the row: its Name, also with "_" for everything but letters and
// digits as pvlib writes it, or a part of it that no other row has. The circuit is that of
// A. Dobos, Journal of Solar Energy Engineering 134 (2012) 021011, with the gap of silicon.
//
// A text with PVObject_=pvModule is a PAN file, of one module. Saturation current and photocurrent
// follow from Isc and Voc with the stated Gamma, RSerie and RShunt; the shunt changes with the
// light by Rp_0 and Rp_Exp (A. Mermoud, T. Lejeune, 25th EU PVSEC (2010), 4BV.1.114). In place of
// an ideality that changes with the temperature (muGamma) the gap is chosen so that the
// open-circuit voltage changes as with it over 10 K. The gaps of PVsyst: silicon 1.12, CdTe 1.5,
// CIS 1.03 eV.
//
// InputError for other texts, a name that no row or several rows have, and figures that are missing
// or that no cell has. A PAN file of amorphous silicon with a recombination term (D2MuTau) is
// refused.
ListedModule module_in(std::string_view text, const std::string& file, const std::string& name);

}  // namespace photorque
