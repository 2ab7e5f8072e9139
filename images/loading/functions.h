// What the module of pictures gives to the program that loads it.
#pragma once

#include <string>

#include "images/writers/image_file.h"
#include "images/writers/read_picture.h"

namespace photorque {

struct PictureFunctions {
  std::string build;  // version and hash of the sources: the program's own, or it is refused
  decltype(&write_exr) exr;
  decltype(&write_tiff) tiff;
  decltype(&write_png) png;
  decltype(&png_bytes) png_in_memory;
  decltype(&read_picture) read;
};

std::string picture_build();

// Of a program that loads them: InputError when the module is not there, told before the work whose
// results could not be written.
void require_pictures();

// The one name that the module exports.
using PictureEntry = const PictureFunctions*();
constexpr const char* picture_entry = "photorque_pictures";

}  // namespace photorque
