#include "diagnosis/verdict.h"

namespace photorque {

Verdict verdict_of(inference::Finding finding) {
  switch (finding) {
    case inference::Finding::nothing_missing:
      return Verdict::consistent;
    case inference::Finding::named:
      return Verdict::missing_physics;
    case inference::Finding::unknown:
      return Verdict::unexplained;
  }
  return Verdict::unexplained;
}

}  // namespace photorque
