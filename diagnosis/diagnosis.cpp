#include "diagnosis/diagnosis.h"

namespace photorque {

std::string name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::consistent:
      return "consistent";
    case Verdict::missing_physics:
      return "missing_physics";
    case Verdict::unexplained:
      return "unexplained";
  }
  return "";
}

}  // namespace photorque
