#include "raytrace/surfaces/surface.h"

namespace photorque {

OpticalSurface grey_surface(std::string name, double specular, double diffuse, double transmitted) {
  OpticalSurface surface;
  surface.name = std::move(name);
  surface.absorbed.fill(1.0 - specular - diffuse - transmitted);
  surface.specular.fill(specular);
  surface.diffuse.fill(diffuse);
  surface.transmitted.fill(transmitted);
  return surface;
}

}  // namespace photorque
