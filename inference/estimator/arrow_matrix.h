// The normal equations of least squares over several runs.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace photorque::inference {

// Sums over the data for one least-squares step.

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

// The symmetric matrix of least squares over several runs.
//
// Parameters of one run alone (its initial conditions, its instrument's bias) meet the shared
// parameters but no other run's:
//
//   ⎡ A₁          B₁ᵀ ⎤
//   ⎢     A₂      B₂ᵀ ⎥      A: own by own, B: shared by own, C: shared by shared
//   ⎣ B₁  B₂  …   C   ⎦
//
// The runs' own are eliminated one by one, so everything costs as much as the number of runs, not
// its third power: hundreds of short pieces of a recording are fitted together.
//
// Source: B. Triggs et al., "Bundle Adjustment — A Modern Synthesis" (2000), section 6.3.

class ArrowMatrix {
 public:
  using Index = Eigen::Index;

  ArrowMatrix() = default;
  // Zeros.
  ArrowMatrix(Index runs, Index per_run, Index shared);

  Index size() const { return first_shared() + shared_.rows(); }
  Index first_shared() const { return static_cast<Index>(own_.size()) * per_run_; }
  bool all_finite() const;

  // Adds one run's Jᵀ J: by its own parameters, then the shared ones.
  void add(Index run, const Eigen::MatrixXd& square);
  void add_to_diagonal(Index i, double by);

  Eigen::VectorXd diagonal() const;
  Eigen::MatrixXd dense() const;
  // By the shared parameters.
  const Eigen::MatrixXd& shared() const { return shared_; }
  Eigen::VectorXd operator*(const Eigen::VectorXd& x) const;
  // diag(s) M diag(s).
  ArrowMatrix scaled(const Eigen::VectorXd& s) const;
  // Row and column i become those of the unit matrix: parameter i is held.
  void hold(Index i);

  // The rest below is for matrices that are positive definite, as priors and damping make them.
  Eigen::VectorXd solve(const Eigen::VectorXd& x) const;
  // Its natural logarithm; pivots below 1e-12 of the diagonal count as that.
  double log_determinant() const;
  // C − Σ B A⁻¹ Bᵀ: the information about the shared parameters with free parameters of the runs.
  // Its inverse is the shared block of the inverse.
  Eigen::MatrixXd shared_information() const;
  // The information and the gradient of the shared parameters, with the runs' own eliminated.
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

  // By the shared parameters alone, the runs' own projected out; χ² is that of all as it is.
  NormalSums of_shared() const { return matrix.shared_sums(gradient, chi2, samples); }
};

}  // namespace photorque::inference
