#include "raytrace/surfaces/fresnel.h"

#include <cmath>

namespace photorque {

double refracted_cosine(double cosine, double index) {
  return std::sqrt(1.0 - (1.0 - cosine * cosine) / (index * index));
}

double fresnel_reflectance(double cosine, double index) {
  if (index == 1.0) return 0.0;  // at grazing incidence too
  const double inside = refracted_cosine(cosine, index);
  const double across = (cosine - index * inside) / (cosine + index * inside);
  const double within = (index * cosine - inside) / (index * cosine + inside);
  return 0.5 * (across * across + within * within);
}

}  // namespace photorque
