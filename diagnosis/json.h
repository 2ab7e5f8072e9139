// diagnosis.json: a machine-readable diagnosis.
#pragma once

#include <string>

#include "core/provenance.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// The schema photorque.diagnosis/1. Parameters have the unit in the name of their key; an array of
// one number becomes a number. Non-finite values are null. Series are omitted; the report has them.
// Keys added after the first version of the schema: "sentence", "warnings", "manoeuvres",
// "empirical_torque", "beliefs_refined", "provenance". Ends with a line break.
std::string diagnosis_json(const Diagnosis& diagnosis, const Provenance& provenance);

}  // namespace photorque
