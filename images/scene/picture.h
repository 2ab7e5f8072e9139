// The picture of the `render` command: a scene with the irradiance painted on its receivers.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "core/provenance.h"
#include "images/canvas/picture.h"
#include "images/scene/shading.h"

namespace photorque {

struct SceneLabels {
  std::string title;
  std::string caption = {};
  std::string unit = "W/m²";
  // Irradiance at the end of the colour scale, which starts at zero; the largest in view if absent.
  std::optional<double> scale_end_W_m2 = {};
  // The unit vectors of the body's x, y and z in camera axes (x right, y up, z towards the viewer):
  // drawn as a small triad in the lower left corner.
  std::optional<std::array<Vec3, 3>> body_axes_camera = {};
};

// The view at its own pixels, with title, colour bar (where a receiver is in view), caption and
// provenance around it. InputError if the sizes of the arrays disagree.
Picture scene_picture(const SceneView& view, const SceneLabels& labels,
                      const Provenance& provenance);

// Written as PNG with the provenance as metadata.
void write_scene_picture(const std::filesystem::path& path, const Picture& picture,
                         const std::string& title, const Provenance& provenance);

}  // namespace photorque
