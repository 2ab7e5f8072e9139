// The pages of the commands: results with their scene.
#pragma once

#include <string>

#include "core/provenance.h"
#include "diagnosis/diagnosis.h"
#include "images/browser/stage.h"
#include "tools/runs/optical_run.h"
#include "tools/runs/result.h"

namespace photorque {

struct MotionRun;
struct WrenchTable;

// Properties of a run on a page in addition to its results.
struct PageHead {
  std::string title;  // the experiment's name
  std::string verb;
  std::string command;  // command that reproduces the run
};

// Page of a run of `trace` or `power`.
RunFile light_page(const OpticalRun& run, const OpticalResult& light, const RunResult& result,
                   const PageHead& head);

// Adds every traced node to a stage: the body at an attitude or direction of light with its maps,
// which are not part of the run's result. The stage must outlive the function.
NodeWatch add_to(SceneStage& stage);
// Page of a table of torques; `stage` contains its nodes.
RunFile torque_map_page(const OpticalRun& run, const WrenchTable& table, const RunResult& result,
                        SceneStage stage, const PageHead& head);

// Page of the platform's motion, which can be played over time. If the experiment has a scene, it
// is shown with light traced at some instants of the run; otherwise an ellipsoid with the
// platform's moments of inertia.
RunFile motion_page(const MotionRun& run, const RunOptions& options, const PageHead& head);

// Text of report.html of a diagnosis, without a script. It contains the finding in one sentence,
// the effects with their numbers and their positions on the array, the deviations of the recordings
// from the nominal model, the ranking of the alternatives, readings with predictions and shaded
// held-out data, and the quality of the data.
std::string report_html(const Diagnosis& diagnosis, const Provenance& provenance,
                        const std::string& title);
// Plots and maps of a diagnosis for figures in a paper: readings, both models and residuals of
// every channel, sweep and scan; and empirical torques. `of_light` as below.
Product diagnosis_figures(const Diagnosis& diagnosis, bool of_light);
// Interactive report: the scene, curves and maps replace the static readings. If the experiment has
// a scene with lamps, it is shown; for motion without one, an ellipsoid with the platform's moments
// of inertia; for curves of a module no scene. `of_light`: the recordings are scans, sweeps and
// runs of light instead of motion.
std::string interactive_report_html(const Diagnosis& d, const Provenance& provenance, bool of_light,
                                    const RunOptions& options, const PageHead& head);

}  // namespace photorque
