// Curves that no module gives: the columns differ from their header.
#pragma once

#include "diagnosis/light/module/design.h"
#include "diagnosis/light/module/nominal.h"

namespace photorque {

// The light of a curve over that of the reference, by the current at the lowest voltage; ≥ 1e-3.
double light_of(const ModuleSweep& sweep, const ModuleNominal& nominal);

// InputError for currents and voltages that no light and no temperature gives: a wrong unit, or
// exchanged columns.
void require_plausible(const ModuleSweep& sweep, const ModuleDesign& design,
                       const ModuleNominal& nominal);

// InputError for a current that is counted into the module.
void require_current_forward(const LightRecording& recording);

// InputError for a scan or a run.
void require_curve(const LightRecording& recording);

}  // namespace photorque
