// The pages of the commands: results with their scene.
#pragma once

#include <memory>
#include <string>

#include "core/provenance.h"
#include "diagnosis/diagnosis.h"
#include "tools/runs/optical_run.h"
#include "tools/runs/result.h"

namespace photorque {

struct MotionRun;
struct SceneStage;
struct WrenchTable;

// Properties of the run on a page beside its results.
struct PageHead {
  std::string title;  // the experiment's name
  std::string verb;
  std::string command;  // that makes it again
};

// The page of a run of that verb, trace or power.
RunFile light_page(const OpticalRun& run, const OpticalResult& light, const RunResult& result,
                   const PageHead& head);

// The body at every attitude or direction of light. It grows while the nodes are traced, since
// their maps are not part of the run's result.
class TorqueMapStage {
 public:
  TorqueMapStage();
  // Valid as long as this.
  NodeWatch watch();

 private:
  friend RunFile torque_map_page(const OpticalRun&, const WrenchTable&, const RunResult&,
                                 TorqueMapStage, const PageHead&);
  std::shared_ptr<SceneStage> stage_;
};
RunFile torque_map_page(const OpticalRun& run, const WrenchTable& table, const RunResult& result,
                        TorqueMapStage stage, const PageHead& head);

// The platform as it moves, played over time. Where the experiment has a scene, that scene, with
// its light traced at some instants of the run; otherwise an ellipsoid with the platform's moments
// of inertia.
RunFile motion_page(const MotionRun& run, const RunOptions& options, const PageHead& head);

// report.html of a diagnosis: the finding in one sentence, the effects with their numbers and
// places on the array, where recording and nominal model part, the ranking of the alternatives,
// readings beside predictions with the part that was never fitted shaded, and the quality of the
// data. It needs no script.
std::string report_html(const Diagnosis& diagnosis, const Provenance& provenance,
                        const std::string& title);
// The plots and maps of a diagnosis for figures in a paper: of every channel, sweep and scan the
// readings, both models and the residuals, and torques without a law. `of_light` as below.
Product diagnosis_figures(const Diagnosis& diagnosis, bool of_light);
// The page with the scene, and curves and maps to point at, in place of the drawn readings. Where
// the experiment has a scene with lamps, that scene; for motion without one an ellipsoid with the
// platform's moments of inertia; for curves of a module no scene at all. `of_light`: the recordings
// are scans, sweeps and runs of light instead of motion.
std::string interactive_report_html(const Diagnosis& d, const Provenance& provenance, bool of_light,
                                    const RunOptions& options, const PageHead& head);

}  // namespace photorque
