// Modules in files of libraries and manufacturers: rows of the CEC library of SAM, PAN files of
// PVsyst.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "photovoltaics/fit/fit.h"

namespace photorque {

// A module, the circuit of one of its cells, and its ratings.
struct ListedModule {
  std::string name;
  int cells_in_series = 1;
  int strings = 1;       // parallel strings of cells
  double area_m2 = 0.0;  // of the module, or of all cells if that of a cell is stated; 0: neither
  CellModel cell;        // for the cell's part of that area, or for 1 m² if it is not stated
  double photocurrent_A = 0.0;  // photocurrent of a cell in the light of `rated`
  RatedPoint rated;
  std::vector<std::string> notes;  // on a circuit that is not the stated one, and on unused parts

  // Values of the circuit of all cells; the photocurrent is proportional to the light.
  RatedPoint predict(double irradiance_W_m2, double temperature_K) const;
};

// The module that a text describes; `file` is its name in messages.
//
// A table with the columns A_c, N_s, alpha_sc, a_ref, I_L_ref, I_o_ref, R_s, R_sh_ref and Adjust is
// a library of SAM. `name` selects the row: its Name, which may have "_" in place of everything but
// letters and digits as in pvlib, or a part of it that no other row has. The circuit is that of A.
// Dobos, Journal of Solar Energy Engineering 134 (2012) 021011, with the gap of silicon.
//
// A text with PVObject_=pvModule is a PAN file of one module. Saturation current and photocurrent
// follow from Isc and Voc with the stated Gamma, RSerie and RShunt. The shunt depends on the light
// by Rp_0 and Rp_Exp (A. Mermoud, T. Lejeune, 25th EU PVSEC (2010), 4BV.1.114). An ideality that
// depends on the temperature (muGamma) is replaced by a gap that gives the same change of the
// open-circuit voltage over 10 K. The gaps of PVsyst: silicon 1.12, CdTe 1.5, CIS 1.03 eV.
//
// Throws InputError for other texts, for a name that no row or several rows have, and for values
// that are missing or that no cell has. In PAN files with a recombination term (D2MuTau: CdTe and
// amorphous silicon) the diode is fitted to the rated figures, and the gap to the slope of the
// maximum power (muPmpReq). Of amorphous silicon only those are accepted.
ListedModule module_in(std::string_view text, const std::string& file, const std::string& name);

}  // namespace photorque
