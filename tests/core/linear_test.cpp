#include "core/numerics/linear.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/transform.h"

namespace photorque {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

TEST(Linear, LeastSquaresOfUndeterminedSystemsAreShortest) {
  const MatrixXd A = MatrixXd::Ones(1, 2);
  const LeastSquares fit = least_squares(A, MatrixXd::Constant(1, 1, 2.0));
  EXPECT_EQ(fit.rank, 1);
  EXPECT_NEAR(fit.solution(0), 1.0, 1e-15);
  EXPECT_NEAR(fit.solution(1), 1.0, 1e-15);
}

TEST(Linear, PivotsBelowTheThresholdCountAsZero) {
  MatrixXd A = MatrixXd::Identity(2, 2);
  A(1, 1) = 1e-4;
  EXPECT_EQ(least_squares(A, Vector2d(1, 1)).rank, 2);
  const LeastSquares fit = least_squares(A, Vector2d(1, 1), 1e-3);
  EXPECT_EQ(fit.rank, 1);
  EXPECT_EQ(fit.solution(1), 0.0);
}

// C⁻¹ of {{2, 1}, {1, 2}} is {{2, −1}, {−1, 2}} / 3. Other units change nothing.
TEST(Linear, SquaredDistanceHasNoUnit) {
  Matrix2d C;
  C << 2, 1, 1, 2;
  EXPECT_NEAR(squared_distance(Vector2d(1, 1), C), 2.0 / 3.0, 1e-14);
  EXPECT_NEAR(squared_distance(Vector2d(1, -1), C), 2.0, 1e-14);
  const Vector2d unit(1e-12, 1e9);
  EXPECT_NEAR(squared_distance(unit.cwiseProduct(Vector2d(1, -1)),
                               unit.asDiagonal() * C * unit.asDiagonal()),
              2.0, 1e-13);
}

TEST(Linear, EigenvaluesAscend) {
  Matrix2d A;
  A << 2, 1, 1, 2;
  const SymmetricEigen eigen = symmetric_eigen(A);
  EXPECT_NEAR(eigen.values[0], 1.0, 1e-14);
  EXPECT_NEAR(eigen.values[1], 3.0, 1e-14);
  EXPECT_NEAR(std::abs(eigen.vectors.col(1).sum()), std::sqrt(2.0), 1e-14);
}

TEST(Linear, EigenvaluesOfANonFiniteMatrixAreNotFinite) {
  const MatrixXd A = MatrixXd::Constant(2, 2, std::nan(""));
  EXPECT_FALSE(symmetric_eigen(A).values.allFinite());
}

TEST(Transform, RotationBetweenOppositesIsAHalfTurn) {
  for (const Vec3& to : {Vec3(0, 0, -3), Vec3(1, 2, 3)}) {
    const Vec3 turned = rotation_between(Vec3(0, 0, 2), to) * Vec3::UnitZ();
    EXPECT_LT((turned - to.normalized()).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace photorque
