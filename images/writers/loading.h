// Picture files without linking OpenImageIO, which has two hundred dependencies (video, volumes,
// OpenGL) and takes 0.2 s to load. A module with it is loaded when the first picture is written or
// read.
#pragma once

#include <string>

#include "core/provenance.h"
#include "images/writers/image_file.h"

namespace photorque {

// Functions of the module.
struct PictureFunctions {
  std::string build;  // version and hash of the sources; must equal the program's
  decltype(&write_exr) exr;
  decltype(&write_tiff) tiff;
  decltype(&write_png) png;
  decltype(&read_picture) read;
};

inline std::string picture_build() {
  const Provenance build = build_provenance();
  return build.version + " " + build.git_hash;
}

// Throws InputError if the module is missing. Called before work whose results could not be
// written.
void require_pictures();

// The only exported name of the module.
using PictureEntry = const PictureFunctions*();
constexpr const char* picture_entry = "photorque_pictures";

}  // namespace photorque
