#include "raytrace/surfaces/cosine_table.h"

namespace photorque {

double even_mean(const std::function<double(double cosine)>& g) {
  constexpr int steps = 4096;
  double sum = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const double root = static_cast<double>(i) / steps, cosine = root * root;
    const double weight = i == 0 || i == steps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    // 2 μ dμ = 4 x³ dx with x the root.
    sum += weight * 4.0 * root * cosine * g(cosine);
  }
  return sum / (3.0 * steps);
}

}  // namespace photorque
