#include "diagnosis/verdict.h"

#include "core/text/format.h"

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

std::string untested_names(const Holdout& holdout) {
  return printed(
      "the held-out data do not test the names: the nominal model predicts it as well "
      "(χ² per sample %.3g, with the names %.3g)",
      holdout.chi2_per_sample_before, holdout.chi2_per_sample_after);
}

}  // namespace photorque
