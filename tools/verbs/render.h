// A picture of the scene with the irradiance on its receivers.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "images/drawing/canvas.h"
#include "tools/runs/optical_run.h"

namespace photorque {

struct RenderRun {
  std::shared_ptr<const OpticalRun> run;
  OpticalResult light;
  Picture picture;    // with title, colour bar, caption and provenance around the view
  std::string title;  // as on the picture
  Provenance provenance;
};

// Traces at the attitude of [attitude] and draws the view of [camera]. Throws InputError like
// run_trace().
RenderRun run_render(const RunOptions& options, const Console& console);

// Writes "render.png" into the folder, replacing that of the last `render`; returns its path.
std::filesystem::path write_render(const RenderRun& rendered, const std::filesystem::path& folder);

}  // namespace photorque
