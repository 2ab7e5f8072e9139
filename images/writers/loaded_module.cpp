// The loadable module with the functions of images/writers/image_file.h.
#include "images/writers/loading.h"

extern "C" __attribute__((visibility("default"))) const photorque::PictureFunctions*
photorque_pictures() {
  static const photorque::PictureFunctions functions{
      photorque::picture_build(), &photorque::write_exr, &photorque::write_tiff,
      &photorque::write_png, &photorque::read_picture};
  return &functions;
}
