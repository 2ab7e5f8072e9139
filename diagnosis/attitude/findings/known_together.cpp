#include "diagnosis/attitude/findings/known_together.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/text/format.h"
#include "diagnosis/attitude/findings/formula.h"

namespace photorque {

std::string known_together(const Vec3& value, const Mat3& covariance) {
  constexpr double by_itself = 2.0, beyond_doubt = 4.0, next_to_nothing = 0.005;
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (!(std::abs(value[k]) <= by_itself * std::sqrt(covariance(k, k)))) return "";
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(covariance);
  double most = beyond_doubt, combined = 0.0, error = 0.0;
  Vec3 best = Vec3::Zero();
  for (Eigen::Index k = 0; k < 3; ++k) {
    Vec3 way = principal.eigenvectors().col(k);
    Eigen::Index largest = 0;
    way.cwiseAbs().maxCoeff(&largest);
    way /= way[largest];
    const double sigma = std::sqrt(std::max(0.0, way.dot(covariance * way)));
    const double sum = way.dot(value);
    if (!(std::abs(sum) > most * sigma)) continue;
    most = std::abs(sum) / sigma;
    best = sum < 0.0 ? Vec3(-way) : way;
    combined = std::abs(sum);
    error = sigma;
  }
  if (combined == 0.0) return "";
  std::string text;
  const char* const axes[] = {"x", "y", "z"};
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double size = std::abs(best[k]);
    if (size < next_to_nothing) continue;
    const bool is_less = best[k] < 0.0;
    text += text.empty() ? (is_less ? "−" : "") : (is_less ? " − " : " + ");
    if (std::abs(size - 1.0) >= next_to_nothing) text += readable_number(size, 2) + " ";
    text += axes[k];
  }
  return text + " = " + with_error(combined, error);
}

}  // namespace photorque
