// Small dense systems. Eigen's decompositions cost every source file that uses them seconds of
// compile time; here they are compiled once.
#pragma once

#include <Eigen/Core>

namespace photorque {

// X of A X = B for a symmetric positive semidefinite A (Eigen::LDLT).
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

// xᵀ C⁻¹ x for a covariance C with positive variances: the squared Mahalanobis distance. C is
// scaled to a unit diagonal first, so that no result depends on units.
double squared_distance(const Eigen::VectorXd& x, const Eigen::MatrixXd& C);

struct LeastSquares {
  Eigen::MatrixXd solution;  // one column for each column of B
  Eigen::Index rank = 0;     // rank of A
};
// The X of minimum norm that minimises |A X − B| (Eigen::CompleteOrthogonalDecomposition). Pivots
// below `threshold` of the largest count as zero; 0: only rounding errors count as zero.
LeastSquares least_squares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                           double threshold = 0.0);

struct SymmetricEigen {
  Eigen::VectorXd values;   // ascending; not finite where A is not
  Eigen::MatrixXd vectors;  // columns of unit length
};
// Eigenvalues and eigenvectors of a symmetric matrix.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A);

}  // namespace photorque
