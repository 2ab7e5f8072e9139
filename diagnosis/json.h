// diagnosis.json: a diagnosis for programs.
#pragma once

#include <string>

#include "core/provenance.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// The schema photorque.diagnosis/1. Parameters stand in the unit that their key names; an array of
// one number stands as a number. What is not finite is null. Series are left out: they are the
// report's. Keys beyond the schema's first version: "sentence", "warnings", "manoeuvres",
// "empirical_torque", "beliefs_refined", "provenance". Ends in a line break.
std::string diagnosis_json(const Diagnosis& diagnosis, const Provenance& provenance);

}  // namespace photorque
