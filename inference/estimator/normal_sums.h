// What a least-squares step needs to know of the data.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace photorque::inference {

// Residuals are r = (measured − predicted)/noise, so that good ones have unit variance, and slopes
// J = ∂(predicted/noise)/∂θ: a step δ turns r into r − J δ, to first order.
struct NormalSums {
  Eigen::MatrixXd matrix;    // Jᵀ J, both triangles
  Eigen::VectorXd gradient;  // Jᵀ r, which is −½ ∂χ²/∂θ
  double chi2 = 0.0;         // rᵀ r
  int64_t samples = 0;       // residuals
};

// Collects residuals one by one and adds their squares in blocks: no matrix of all slopes is kept.
class SumsOfRows {
 public:
  explicit SumsOfRows(Eigen::Index parameters);

  // The next row, to be filled: the slopes, then the residual.
  auto next() {
    if (used_ == capacity) flush();
    ++samples_;
    return rows_.row(used_++);
  }

  NormalSums finish();

 private:
  static constexpr Eigen::Index capacity = 192;
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  void flush();

  Eigen::Index width_;
  RowMatrix rows_;
  Eigen::MatrixXd square_;
  Eigen::Index used_ = 0;
  int64_t samples_ = 0;
};

}  // namespace photorque::inference
