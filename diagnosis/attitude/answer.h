// What the search and the decision make of recordings.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/attitude/recorded_data.h"
#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

// All that was fitted, and what is made of it.
struct Answer {
  Candidates all;
  std::vector<Trial> trials;
  // Before the runs held out count: in one that diverges there all explanations differ by chance.
  std::vector<Where::Dependence> depends_on;
  inference::Decision decision;

  const Trial& chosen() const { return trials[decision.chosen]; }
};

// All candidates; those that need no scan for where to begin; of these the torques of the catalogue
// alone, because instruments that are wrong enough stand in for anything.
enum class Among { all, unscanned, plain_physics };

// Score every effect, fit, compare, weigh with what was held out, decide.
Answer explain(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
               const DiagnoseOptions& options, Among among = Among::all);

// The nominal model alone, and that it leaves more than noise.
Answer unexplained(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
                   const Thresholds& limits);

// What stands out although something unexplained is left, which counts as noise: at first all that
// the nominal model leaves, then what the best explanation does, as long as names come out of it.
// Under as little noise as that of the readings alone whatever is uncertain would give way to
// anything.
std::optional<Answer> named_beside_the_rest(const NominalModel& nominal, RecordedData data,
                                            const DiagnoseOptions& options);

// The one torque of the catalogue that predicts most stretches better than the nominal model, each
// stretch from fits to others, where a recording has many of them: by ranks, because what is left
// over is as irregular as it is. Nothing where none does beyond doubt.
std::optional<Answer> named_over_stretches(const NominalModel& nominal, RecordedData data,
                                           const DiagnoseOptions& options);

// What describes the motion best, known or not, with all that the nominal model leaves counted as
// noise: where the nominal model is far off and no names come out of it.
Answer explained_in_the_rough(const NominalModel& nominal, RecordedData data,
                              const DiagnoseOptions& options);

void tell(const DiagnoseOptions& options, const std::string& what);

}  // namespace photorque
