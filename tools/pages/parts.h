// The parts of the commands' pages: figures, the scene as a stage, recordings.
#pragma once

#include <string>
#include <vector>

#include "attitude/model/platform.h"
#include "diagnosis/diagnosis.h"
#include "images/browser/run_page.h"
#include "images/browser/stage.h"
#include "tools/pages/pages.h"

namespace photorque {

// The page of a run without its stage. Figures have names and units as printed; those whose names
// begin with one of `headlines` are at the top (at most six, in this order).
RunPage page_of(const RunResult& result, const PageHead& head,
                const std::vector<std::string>& headlines);

// The way of the power through a run: of the array's table "losses" where there is one, otherwise
// from the lamps to the parts that carry flux maps.
std::vector<PowerStage> power_stages(const OpticalRun& run, const OpticalResult& light,
                                     const Product& product);

// "page.html", made when it is written.
RunFile page_file(RunPage page);

// The place of the value nearest to a time in a rising list.
size_t nearest_instant(const std::vector<double>& time_s, double at_s);
void add_sentence(std::string& text, const std::string& sentence);

// Parts, lamps and camera, and the surfaces of all flux maps, in one painting of their irradiance,
// and of torque maps, one for each axis; no states yet. With `maps` = "own" their maps come with
// add_light(); otherwise the surfaces name those of OpticalRun::product().
enum class StageMaps { of_product, own };
SceneStage stage_of(const OpticalRun& run, StageMaps maps);

// A grey that shows how much a surface reflects; the eye takes reflectance in powers.
Rgb reflectance_grey(const OpticalSurface& surface);

// Force and torque of the light at an attitude, about the centre of rotation.
StageState lit_state(const OpticalRun& run, const RigidTransform& lab_from_body,
                     const OpticalResult& result);

// One of `lights` that the stage will have: rays and, for surfaces with maps, the irradiance; the
// more lights, the fewer rays and bins.
void add_light(SceneStage& stage, const OpticalRun& run, const RigidTransform& lab_from_body,
               const OpticalResult& result, size_t lights);

// The light at up to 12 of some attitudes of the body, evenly over them; each of them shows the
// nearest, and the stage's remark states it.
void light_along(SceneStage& stage, const OpticalRun& run, const std::vector<Quat>& lab_from_body);

// The surface of a receiver's bins, to be painted with maps that the caller gives.
PaintedSurface painted_receiver(const OpticalRun& run, const std::string& receiver);

// The even ellipsoid whose principal moments are in the platform's proportions, half as long as
// 1 m at its longest, and a rod along body x; camera and radius to match, and a remark that
// states it. A platform about one axis has one moment: a disc about that axis.
SceneStage platform_stage(const Platform& platform);

// Recordings as the user provided them: held-out ends are joined to their recordings, names are
// those of files, and each occurs once. At most `most`.
std::vector<RecordingSeries> shown_recordings(const Diagnosis& diagnosis, size_t most);

// Shows the measured body with both models over time, and their differences as arrows. Without a
// recorded attitude it shows the rates, in body axes. `stage` contains the body.
void show_motion(const std::vector<RecordingSeries>& recordings, bool something_was_found,
                 SceneStage stage, RunPage& page);

// Scans as maps on the receiver, runs over time, sweeps at their attitudes. Without a scene curves
// alone.
void show_light(const std::vector<RecordingSeries>& recordings, bool something_was_found,
                const OpticalRun* run, RunPage& page);

// Adds a plot of every channel, readings with both models, whose name ends in `suffix`. If there is
// a slider, the plots have its line (the plot that it names is filled in).
void add_curves(const RecordingSeries& recording, const std::string& suffix,
                const std::optional<PlotCursor>& cursor, RunPage& page);

// The text of report.html before and after the readings, as HTML: the finding, the effects; where
// it is seen, the ranking of the alternatives, the quality of the data.
std::string report_findings(const Diagnosis& diagnosis, const std::string& title);
std::string report_evidence(const Diagnosis& diagnosis);

}  // namespace photorque
