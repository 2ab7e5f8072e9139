#include "inference/estimator/arrow_matrix.h"

#include <Eigen/Cholesky>

#include <algorithm>

#include "core/numerics/linear.h"
#include "inference/estimator/covariance.h"

namespace photorque::inference {

Eigen::VectorXd inverse_roots(const Eigen::VectorXd& diagonal, double otherwise) {
  return diagonal.cwiseSqrt().unaryExpr(
      [&](double root) { return root > 0.0 ? 1.0 / root : otherwise; });
}

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

namespace {

// A⁻¹ Bᵀ. Eigen would use pointer arithmetic on a null pointer where B has no rows.
Eigen::MatrixXd eliminated(const Eigen::LDLT<Eigen::MatrixXd>& own, const Eigen::MatrixXd& cross) {
  if (cross.size() == 0) return Eigen::MatrixXd(cross.cols(), cross.rows());
  return own.solve(cross.transpose());
}

}  // namespace

ArrowMatrix::ArrowMatrix(Index runs, Index per_run, Index shared)
    : per_run_(per_run),
      own_(static_cast<size_t>(runs), Eigen::MatrixXd::Zero(per_run, per_run)),
      cross_(static_cast<size_t>(runs), Eigen::MatrixXd::Zero(shared, per_run)),
      shared_(Eigen::MatrixXd::Zero(shared, shared)) {}

bool ArrowMatrix::all_finite() const {
  const auto finite = [](const Eigen::MatrixXd& m) { return m.allFinite(); };
  return shared_.allFinite() && std::all_of(own_.begin(), own_.end(), finite) &&
         std::all_of(cross_.begin(), cross_.end(), finite);
}

void ArrowMatrix::add(Index run, const Eigen::MatrixXd& square) {
  const Index shared = shared_.rows();
  const auto r = static_cast<size_t>(run);
  own_[r] += square.topLeftCorner(per_run_, per_run_);
  cross_[r] += square.bottomLeftCorner(shared, per_run_);
  shared_ += square.bottomRightCorner(shared, shared);
}

void ArrowMatrix::add_to_diagonal(Index i, double by) {
  if (i >= first_shared()) {
    shared_.diagonal()[i - first_shared()] += by;
  } else {
    own_[static_cast<size_t>(i / per_run_)].diagonal()[i % per_run_] += by;
  }
}

Eigen::VectorXd ArrowMatrix::diagonal() const {
  Eigen::VectorXd d(size());
  for (size_t run = 0; run < own_.size(); ++run) part(d, run) = own_[run].diagonal();
  d.tail(shared_.rows()) = shared_.diagonal();
  return d;
}

Eigen::MatrixXd ArrowMatrix::dense() const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(size(), size());
  const Index shared = shared_.rows();
  for (size_t run = 0; run < own_.size(); ++run) {
    const Index at = static_cast<Index>(run) * per_run_;
    all.block(at, at, per_run_, per_run_) = own_[run];
    all.block(first_shared(), at, shared, per_run_) = cross_[run];
    all.block(at, first_shared(), per_run_, shared) = cross_[run].transpose();
  }
  all.bottomRightCorner(shared, shared) = shared_;
  return all;
}

Eigen::VectorXd ArrowMatrix::operator*(const Eigen::VectorXd& x) const {
  Eigen::VectorXd y(size());
  const Eigen::VectorXd tail = x.tail(shared_.rows());
  Eigen::VectorXd sum = shared_ * tail;
  for (size_t run = 0; run < own_.size(); ++run) {
    part(y, run) = own_[run] * part(x, run) + cross_[run].transpose() * tail;
    sum += cross_[run] * part(x, run);
  }
  y.tail(shared_.rows()) = sum;
  return y;
}

ArrowMatrix ArrowMatrix::scaled(const Eigen::VectorXd& s) const {
  ArrowMatrix result = *this;
  const Eigen::VectorXd tail = s.tail(shared_.rows());
  for (size_t run = 0; run < own_.size(); ++run) {
    const Eigen::VectorXd own = part(s, run);
    result.own_[run] = own.asDiagonal() * own_[run] * own.asDiagonal();
    result.cross_[run] = tail.asDiagonal() * cross_[run] * own.asDiagonal();
  }
  result.shared_ = tail.asDiagonal() * shared_ * tail.asDiagonal();
  return result;
}

void ArrowMatrix::hold(Index i) {
  if (i >= first_shared()) {
    const Index k = i - first_shared();
    for (Eigen::MatrixXd& cross : cross_) {
      if (per_run_ > 0) cross.row(k).setZero();  // otherwise its data pointer is null
    }
    shared_.row(k).setZero();
    shared_.col(k).setZero();
    shared_(k, k) = 1.0;
    return;
  }
  const auto run = static_cast<size_t>(i / per_run_);
  const Index k = i % per_run_;
  own_[run].row(k).setZero();
  own_[run].col(k).setZero();
  own_[run](k, k) = 1.0;
  cross_[run].col(k).setZero();
}

Eigen::VectorXd ArrowMatrix::solve(const Eigen::VectorXd& x) const {
  Eigen::VectorXd y(size());
  Eigen::MatrixXd left = shared_;
  Eigen::VectorXd right = x.tail(shared_.rows());
  std::vector<Eigen::MatrixXd> columns;
  for (size_t run = 0; run < own_.size(); ++run) {
    const Eigen::LDLT<Eigen::MatrixXd> factors(own_[run]);
    columns.push_back(eliminated(factors, cross_[run]));
    part(y, run) = factors.solve(Eigen::VectorXd(part(x, run)));
    left -= cross_[run] * columns.back();
    right -= cross_[run] * part(y, run);
  }
  if (shared_.rows() == 0) return y;
  const Eigen::VectorXd tail = solve_symmetric(left, right);
  for (size_t run = 0; run < own_.size(); ++run) part(y, run) -= columns[run] * tail;
  y.tail(shared_.rows()) = tail;
  return y;
}

double ArrowMatrix::log_determinant() const {
  double sum = shared_.rows() > 0 ? inference::log_determinant(shared_information()) : 0.0;
  for (const Eigen::MatrixXd& own : own_) {
    if (per_run_ > 0) sum += inference::log_determinant(own);
  }
  return sum;
}

Eigen::MatrixXd ArrowMatrix::shared_information() const {
  return shared_sums(Eigen::VectorXd::Zero(size()), 0.0, 0).matrix;
}

NormalSums ArrowMatrix::shared_sums(const Eigen::VectorXd& gradient, double chi2,
                                    int64_t samples) const {
  NormalSums sums{shared_, gradient.tail(shared_.rows()), chi2, samples};
  for (size_t run = 0; run < own_.size(); ++run) {
    const Eigen::LDLT<Eigen::MatrixXd> factors(own_[run]);
    sums.matrix -= cross_[run] * eliminated(factors, cross_[run]);
    sums.gradient -= cross_[run] * factors.solve(Eigen::VectorXd(part(gradient, run)));
  }
  return sums;
}

}  // namespace photorque::inference
