// The functions of FMI 3.0 that the unit does not have. Some importers look for every name.
#include "tools/fmi/instance.h"

using namespace photorque::fmi;

// NOLINTBEGIN(readability-identifier-naming)
#define PHOTORQUE_ABSENT(name)                                               \
  PHOTORQUE_EXPORT fmi3Status name(fmi3Instance handle) {                    \
    return guarded(handle, #name, [](Instance& instance) {                   \
      return instance.refuse(#name " is not offered: modelDescription.xml"); \
    });                                                                      \
  }
PHOTORQUE_ABSENT(fmi3GetFloat32)
PHOTORQUE_ABSENT(fmi3GetInt8)
PHOTORQUE_ABSENT(fmi3GetUInt8)
PHOTORQUE_ABSENT(fmi3GetInt16)
PHOTORQUE_ABSENT(fmi3GetUInt16)
PHOTORQUE_ABSENT(fmi3GetInt32)
PHOTORQUE_ABSENT(fmi3GetUInt32)
PHOTORQUE_ABSENT(fmi3GetInt64)
PHOTORQUE_ABSENT(fmi3GetUInt64)
PHOTORQUE_ABSENT(fmi3GetString)
PHOTORQUE_ABSENT(fmi3GetBinary)
PHOTORQUE_ABSENT(fmi3GetClock)
PHOTORQUE_ABSENT(fmi3SetFloat32)
PHOTORQUE_ABSENT(fmi3SetInt8)
PHOTORQUE_ABSENT(fmi3SetUInt8)
PHOTORQUE_ABSENT(fmi3SetInt16)
PHOTORQUE_ABSENT(fmi3SetUInt16)
PHOTORQUE_ABSENT(fmi3SetInt32)
PHOTORQUE_ABSENT(fmi3SetUInt32)
PHOTORQUE_ABSENT(fmi3SetInt64)
PHOTORQUE_ABSENT(fmi3SetUInt64)
PHOTORQUE_ABSENT(fmi3SetBoolean)
PHOTORQUE_ABSENT(fmi3SetString)
PHOTORQUE_ABSENT(fmi3SetBinary)
PHOTORQUE_ABSENT(fmi3SetClock)
PHOTORQUE_ABSENT(fmi3GetNumberOfVariableDependencies)
PHOTORQUE_ABSENT(fmi3GetVariableDependencies)
PHOTORQUE_ABSENT(fmi3GetDirectionalDerivative)
PHOTORQUE_ABSENT(fmi3GetAdjointDerivative)
PHOTORQUE_ABSENT(fmi3EnterConfigurationMode)
PHOTORQUE_ABSENT(fmi3ExitConfigurationMode)
PHOTORQUE_ABSENT(fmi3GetIntervalDecimal)
PHOTORQUE_ABSENT(fmi3GetIntervalFraction)
PHOTORQUE_ABSENT(fmi3GetShiftDecimal)
PHOTORQUE_ABSENT(fmi3GetShiftFraction)
PHOTORQUE_ABSENT(fmi3SetIntervalDecimal)
PHOTORQUE_ABSENT(fmi3SetIntervalFraction)
PHOTORQUE_ABSENT(fmi3SetShiftDecimal)
PHOTORQUE_ABSENT(fmi3SetShiftFraction)
PHOTORQUE_ABSENT(fmi3EvaluateDiscreteStates)
PHOTORQUE_ABSENT(fmi3UpdateDiscreteStates)
PHOTORQUE_ABSENT(fmi3EnterEventMode)
PHOTORQUE_ABSENT(fmi3EnterStepMode)
PHOTORQUE_ABSENT(fmi3GetOutputDerivatives)
PHOTORQUE_ABSENT(fmi3ActivateModelPartition)
// NOLINTEND(readability-identifier-naming)
