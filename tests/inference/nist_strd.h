// Nonlinear regression problems with certified results, one per level of difficulty, from the
// Statistical Reference Datasets of the U.S. National Institute of Standards and Technology (public
// domain): https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace photorque {

struct NistProblem {
  std::string name;
  std::vector<double> x, y;
  std::vector<Eigen::VectorXd> starts;  // two; the second is closer
  // Certified to eleven digits; errors are standard deviations from the scatter.
  Eigen::VectorXd certified, certified_error;
  double residual_squares;
  // f(x; b) and its derivatives with respect to b.
  std::function<double(double x, const Eigen::VectorXd& b, Eigen::VectorXd& slopes)> model;
};

inline Eigen::VectorXd numbers_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

// Lower difficulty. D. Misra, dental research: monomolecular adsorption.
inline NistProblem misra1a() {
  return {"Misra1a",
          {77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1,
           760.0},
          {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40,
           75.47, 81.78},
          {numbers_of({500, 1e-4}), numbers_of({250, 5e-4})},
          numbers_of({2.3894212918e+02, 5.5015643181e-04}),
          numbers_of({2.7070075241e+00, 7.2668688436e-06}),
          1.2455138894e-01,
          [](double x, const Eigen::VectorXd& b, Eigen::VectorXd& slopes) {
            const double decay = std::exp(-b[1] * x);
            slopes << 1.0 - decay, b[0] * x * decay;
            return b[0] * (1.0 - decay);
          }};
}

// Average difficulty. M. Osborne: two exponentials that nearly cancel.
inline NistProblem mgh17() {
  std::vector<double> x;
  for (int i = 0; i < 33; ++i) x.push_back(10.0 * i);
  return {"MGH17",
          x,
          {0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751,
           0.718, 0.685, 0.658, 0.628, 0.603, 0.580, 0.558, 0.538, 0.522, 0.506, 0.490,
           0.478, 0.467, 0.457, 0.448, 0.438, 0.431, 0.424, 0.420, 0.414, 0.411, 0.406},
          {numbers_of({50, 150, -100, 1, 2}), numbers_of({0.5, 1.5, -1, 0.01, 0.02})},
          numbers_of({3.7541005211e-01, 1.9358469127e+00, -1.4646871366e+00, 1.2867534640e-02,
                      2.2122699662e-02}),
          numbers_of({2.0723153551e-03, 2.2031669222e-01, 2.2175707739e-01, 4.4861358114e-04,
                      8.9471996575e-04}),
          5.4648946975e-05,
          [](double t, const Eigen::VectorXd& b, Eigen::VectorXd& slopes) {
            const double first = std::exp(-b[3] * t), second = std::exp(-b[4] * t);
            slopes << 1.0, first, second, -t * b[1] * first, -t * b[2] * second;
            return b[0] + b[1] * first + b[2] * second;
          }};
}

// Higher difficulty. R. Thurber, semiconductor electron mobility: a ratio of cubics.
inline NistProblem thurber() {
  return {"Thurber",
          {-3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481,
           -2.363, -2.322, -1.501, -1.460, -1.274, -1.212, -1.100, -1.046, -0.915, -0.714,
           -0.566, -0.545, -0.400, -0.309, -0.109, -0.103, 0.010,  0.119,  0.377,  0.790,
           0.963,  1.006,  1.115,  1.572,  1.841,  2.047,  2.200},
          {80.574,   84.248,   87.264,   87.195,   89.076,   89.608,   89.868,   90.101,
           92.405,   95.854,   100.696,  101.060,  401.672,  390.724,  567.534,  635.316,
           733.054,  759.087,  894.206,  990.785,  1090.109, 1080.914, 1122.643, 1178.351,
           1260.531, 1273.514, 1288.339, 1327.543, 1353.863, 1414.509, 1425.208, 1421.384,
           1442.962, 1464.350, 1468.705, 1447.894, 1457.628},
          {numbers_of({1000, 1000, 400, 40, 0.7, 0.3, 0.03}),
           numbers_of({1300, 1500, 500, 75, 1, 0.4, 0.05})},
          numbers_of({1.2881396800e+03, 1.4910792535e+03, 5.8323836877e+02, 7.5416644291e+01,
                      9.6629502864e-01, 3.9797285797e-01, 4.9727297349e-02}),
          numbers_of({4.6647963344e+00, 3.9571156086e+01, 2.8698696102e+01, 5.5675370270e+00,
                      3.1333340687e-02, 1.4984928198e-02, 6.5842344623e-03}),
          5.6427082397e+03,
          [](double x, const Eigen::VectorXd& b, Eigen::VectorXd& slopes) {
            const double above = b[0] + x * (b[1] + x * (b[2] + x * b[3]));
            const double below = 1.0 + x * (b[4] + x * (b[5] + x * b[6]));
            const double value = above / below, turn = -value / below;
            slopes << 1.0 / below, x / below, x * x / below, x * x * x / below, turn * x,
                turn * x * x, turn * x * x * x;
            return value;
          }};
}

}  // namespace photorque
