// The normal equations of least squares over several runs.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace photorque::inference {

// 1/√d for each number d of a diagonal, which scales a matrix to a unit diagonal; `otherwise` where
// d is not positive.
Eigen::VectorXd inverse_roots(const Eigen::VectorXd& diagonal, double otherwise = 1.0);

// Sums over the data for one least-squares step. Residuals are r = (measured − predicted)/noise,
// with unit variance for a good fit, and slopes are J = ∂(predicted/noise)/∂θ: to first order a
// step δ changes r into r − J δ.
struct NormalSums {
  Eigen::MatrixXd matrix;    // Jᵀ J, both triangles
  Eigen::VectorXd gradient;  // Jᵀ r, which is −½ ∂χ²/∂θ
  double chi2 = 0.0;         // rᵀ r
  int64_t samples = 0;       // residuals
};

// Accumulates JᵀJ from blocks of residuals, so that the full matrix of slopes is never stored.
class SumsOfRows {
 public:
  explicit SumsOfRows(Eigen::Index parameters);

  // Returns the next row to fill: the slopes, then the residual.
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

// The symmetric matrix of the normal equations over several runs.
//
// Parameters of a single run (its initial conditions, its instrument bias) are coupled to the
// shared parameters but not to those of other runs:
//
//   ⎡ A₁          B₁ᵀ ⎤
//   ⎢     A₂      B₂ᵀ ⎥      A: run by run, B: shared by run, C: shared by shared
//   ⎣ B₁  B₂  …   C   ⎦
//
// The run parameters are eliminated one run at a time (Schur complement). The cost grows linearly
// with the number of runs instead of with its cube. Hundreds of short pieces of a recording can
// therefore be fitted together.
//
// Source: B. Triggs et al., "Bundle Adjustment — A Modern Synthesis" (2000), section 6.3.

class ArrowMatrix {
 public:
  using Index = Eigen::Index;

  ArrowMatrix() = default;
  // Initialises with zeros.
  ArrowMatrix(Index runs, Index per_run, Index shared);

  Index size() const { return first_shared() + shared_.rows(); }
  Index first_shared() const { return static_cast<Index>(own_.size()) * per_run_; }
  bool all_finite() const;

  // Adds the Jᵀ J of one run: first its run parameters, then the shared ones.
  void add(Index run, const Eigen::MatrixXd& square);
  void add_to_diagonal(Index i, double by);

  Eigen::VectorXd diagonal() const;
  Eigen::MatrixXd dense() const;
  // The block C of the shared parameters.
  const Eigen::MatrixXd& shared() const { return shared_; }
  Eigen::VectorXd operator*(const Eigen::VectorXd& x) const;
  // diag(s) M diag(s).
  ArrowMatrix scaled(const Eigen::VectorXd& s) const;
  // Replaces row and column i by those of the unit matrix, which fixes parameter i.
  void hold(Index i);

  // The functions below require a positive definite matrix, which priors and damping provide.
  Eigen::VectorXd solve(const Eigen::VectorXd& x) const;
  // Natural logarithm; pivots are limited to at least 1e-12 of the diagonal.
  double log_determinant() const;
  // C − Σ B A⁻¹ Bᵀ: the information about the shared parameters, marginalised over those of the
  // runs. Its inverse is the shared block of the inverse.
  Eigen::MatrixXd shared_information() const;
  // Information and gradient of the shared parameters, with the run parameters eliminated.
  NormalSums shared_sums(const Eigen::VectorXd& gradient, double chi2, int64_t samples) const;

 private:
  auto part(Eigen::VectorXd& x, size_t run) const {
    return x.segment(static_cast<Index>(run) * per_run_, per_run_);
  }
  auto part(const Eigen::VectorXd& x, size_t run) const {
    return x.segment(static_cast<Index>(run) * per_run_, per_run_);
  }

  Index per_run_ = 0;
  std::vector<Eigen::MatrixXd> own_, cross_;  // A and B of each run
  Eigen::MatrixXd shared_;                    // C
};

// The sums of all runs.
struct SumsOfRuns {
  ArrowMatrix matrix;        // Jᵀ J
  Eigen::VectorXd gradient;  // Jᵀ r
  double chi2 = 0.0;
  int64_t samples = 0;

  // Sums of the shared parameters, with the run parameters projected out; χ² is unchanged.
  NormalSums of_shared() const { return matrix.shared_sums(gradient, chi2, samples); }
};

}  // namespace photorque::inference
