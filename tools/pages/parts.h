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

// Page of a run without its stage. Figures have printed names and units; those whose names begin
// with one of `headlines` are at the top (at most six, in this order).
RunPage page_of(const RunResult& result, const PageHead& head,
                const std::vector<std::string>& headlines);

// The file "page.html"; its content is made when it is written.
RunFile page_file(RunPage page);

// At most `most` of `count` indices, evenly distributed, with the first and the last.
std::vector<size_t> even_indices(size_t count, size_t most);
// Start and end of a recording [s]; without times the end is before the start.
Where::Interval span_of(const RecordingSeries& recording);
// Index of the value nearest to a time in a rising list.
size_t nearest_instant(const std::vector<double>& time_s, double at_s);
void add_sentence(std::string& text, const std::string& sentence);

// Stage with parts, lamps and camera, and with the surfaces of all flux maps (one painting of their
// irradiance) and torque maps (one painting per axis); without states. With `own`, add_light()
// supplies the maps; with `of_product`, the surfaces name those of OpticalRun::product().
enum class StageMaps { of_product, own };
SceneStage stage_of(const OpticalRun& run, StageMaps maps);

// A grey for the reflectance of a surface; perceived lightness follows a power law.
Rgb reflectance_grey(const OpticalSurface& surface);

// Force and torque of light at an attitude, about the centre of rotation.
StageState lit_state(const OpticalRun& run, const RigidTransform& lab_from_body,
                     const OpticalResult& result);

// Adds one of `lights` lights of the stage: rays and, for surfaces with maps, the irradiance. More
// lights have fewer rays and bins each.
void add_light(SceneStage& stage, const OpticalRun& run, const RigidTransform& lab_from_body,
               const OpticalResult& result, size_t lights);

// Adds the light at up to 12 of these attitudes, evenly distributed; each attitude shows the
// nearest. A remark of the stage states this.
void light_along(SceneStage& stage, const OpticalRun& run, const std::vector<Quat>& lab_from_body);

// Stage without a scene: the uniform ellipsoid with the platform's ratios of principal moments, 1 m
// long, and a rod along body x; with camera, radius and a remark. For a platform with a single axis
// it is a disc about this axis.
SceneStage platform_stage(const Platform& platform);

// Recordings as provided by the user: held-out ends are joined to their recordings, names are those
// of the files, and each occurs once. At most `most`.
std::vector<RecordingSeries> shown_recordings(const Diagnosis& diagnosis, size_t most);

// Shows the measured body with both models over time, and their differences as arrows. Without a
// recorded attitude it shows the rates, in body axes. `stage` contains the body.
void show_motion(const std::vector<RecordingSeries>& recordings, bool something_was_found,
                 SceneStage stage, RunPage& page);

// Adds scans as maps on the receiver, runs over time, and sweeps at their attitudes. Without a
// scene only curves.
void show_light(const std::vector<RecordingSeries>& recordings, bool something_was_found,
                const OpticalRun* run, RunPage& page);

// Adds a plot of every channel, readings with both models, with `suffix` at the end of its name.
// With a slider, the plots get its line (`cursor` without its plot name).
void add_curves(const RecordingSeries& recording, const std::string& suffix,
                const std::optional<PlotCursor>& cursor, RunPage& page);

// HTML of report.html before the readings (finding, effects) and after them (deviations, ranking of
// the alternatives, quality of the data).
std::string report_findings(const Diagnosis& diagnosis, const std::string& title);
std::string report_evidence(const Diagnosis& diagnosis);

}  // namespace photorque
