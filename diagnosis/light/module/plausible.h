// Checks for curves that no module produces: columns that differ from their header.
#pragma once

#include "diagnosis/light/module/design.h"
#include "diagnosis/light/module/nominal.h"

namespace photorque {

// Light of a curve relative to the reference, from the current at the lowest voltage; ≥ 1e-3.
double light_of(const ModuleSweep& sweep, const ModuleNominal& nominal);

// Throws InputError for currents and voltages that are impossible in any light at any temperature:
// a wrong unit, or exchanged columns.
void require_plausible(const ModuleSweep& sweep, const ModuleDesign& design,
                       const ModuleNominal& nominal);

// Throws InputError if the current is positive into the module.
void require_current_forward(const LightRecording& recording);

// Throws InputError for a scan or a run.
void require_curve(const LightRecording& recording);

}  // namespace photorque
