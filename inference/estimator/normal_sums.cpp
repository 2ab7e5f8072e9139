#include "inference/estimator/normal_sums.h"

namespace photorque::inference {

SumsOfRows::SumsOfRows(Eigen::Index parameters)
    : width_(parameters + 1),
      rows_(RowMatrix::Zero(capacity, width_)),
      square_(Eigen::MatrixXd::Zero(width_, width_)) {}

void SumsOfRows::flush() {
  square_.selfadjointView<Eigen::Lower>().rankUpdate(rows_.topRows(used_).transpose());
  used_ = 0;
}

NormalSums SumsOfRows::finish() {
  flush();
  const Eigen::MatrixXd full = square_.selfadjointView<Eigen::Lower>();
  const Eigen::Index n = width_ - 1;
  return {full.topLeftCorner(n, n), full.col(n).head(n), full(n, n), samples_};
}

}  // namespace photorque::inference
