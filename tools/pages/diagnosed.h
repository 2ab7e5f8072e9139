// What the recordings of a diagnosis put on its page: scene, maps and curves.
#pragma once

#include "diagnosis/diagnosis.h"
#include "images/browser/run_page.h"
#include "tools/runs/optical_run.h"

namespace photorque {

// Recordings as people know them: the end of one that was held out is part of it again, names are
// those of files and each is there once. At most `most`.
std::vector<RecordingSeries> shown_recordings(const Diagnosis& diagnosis, size_t most);

// The slider over several recordings, the second axis of the stage; numbered from 1.
StageAxis recording_axis(const std::vector<RecordingSeries>& recordings);

// The body as it was measured with both models beside it, its differences as arrows, over time;
// where no attitude was recorded the rates, in body axes. `stage` has the body.
void show_motion(const std::vector<RecordingSeries>& recordings, bool something_was_found,
                 SceneStage stage, RunPage& page);

// Scans as maps on the receiver, runs over time, sweeps at their attitudes. Without a scene curves
// alone.
void show_light(const std::vector<RecordingSeries>& recordings, bool something_was_found,
                const OpticalRun* run, RunPage& page);

// Readings beside both models of every channel, a plot each, whose names end in `suffix`; with the
// line of a slider, where there is one (the plot that it names is filled in).
void add_curves(const RecordingSeries& recording, const std::string& suffix,
                const std::optional<PlotCursor>& cursor, RunPage& page);

}  // namespace photorque
