// Pictures as files for a program that does not link OpenImageIO, which brings two hundred
// libraries (video, volumes, OpenGL) with it and takes 0.2 s to load: they come with a module when
// the first picture is written or read.
#pragma once

#include <string>

#include "core/provenance.h"
#include "images/writers/image_file.h"

namespace photorque {

// The functions of the module for the program that loads it.
struct PictureFunctions {
  std::string build;  // version and hash of the sources: the program's own, or it is refused
  decltype(&write_exr) exr;
  decltype(&write_tiff) tiff;
  decltype(&write_png) png;
  decltype(&read_picture) read;
};

inline std::string picture_build() {
  const Provenance build = build_provenance();
  return build.version + " " + build.git_hash;
}

// InputError when the module is not there, before the work whose results could not be written.
void require_pictures();

// The one name that the module exports.
using PictureEntry = const PictureFunctions*();
constexpr const char* picture_entry = "photorque_pictures";

}  // namespace photorque
