// The program's estimator compared with Eigen's Levenberg–Marquardt (a port of MINPACK) and, if
// installed, Ceres: equal problems with equal derivatives. `digits` is the number of correct digits
// of the worst parameter: relative to certified values, or to the common minimum in standard
// errors.
#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <unsupported/Eigen/NonLinearOptimization>
#ifdef PHOTORQUE_HAS_CERES
#include <ceres/ceres.h>
#endif

#include "attitude/disturbances/kind.h"
#include "attitude/estimation/fit.h"
#include "attitude/estimation/forward_model.h"
#include "attitude/propagation/run.h"
#include "core/constants.h"
#include "core/numerics/random.h"
#include "inference/estimator/fit.h"
#include "inference/estimator/forward_model.h"
#include "tools/benchmarks/nist_strd.h"

namespace photorque {
namespace {

// Standard normal random numbers (G. E. P. Box, M. E. Muller, Ann. Math. Stat. 29, 610).
struct NormalNumbers {
  uint64_t seed, count = 0;
  double operator()() {
    const uint64_t at = count++;
    return std::sqrt(-2.0 * std::log(unit_interval(hash_words(seed, at, 0)))) *
           std::cos(2.0 * std::numbers::pi * unit_interval(hash_words(seed, at, 1)));
  }
};

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

struct Problem {
  std::shared_ptr<const inference::ForwardModel> model;  // for the estimator of the program
  inference::ResidualFunction residuals;                 // for the other programs
  VectorXd start, certified;                             // of the other programs
  VectorXd own_start;
  Index rows = 0;
};

Problem problem_of(const NistProblem& nist, size_t start) {
  Problem p;
  p.rows = static_cast<Index>(nist.x.size());
  p.start = p.own_start = nist.starts[start];
  p.certified = nist.certified;
  p.residuals = [nist](const VectorXd& b, Index, VectorXd& residuals, MatrixXd* slopes) {
    const auto rows = static_cast<Index>(nist.x.size());
    residuals.resize(rows);
    if (slopes != nullptr) slopes->resize(rows, b.size());
    VectorXd row(b.size());
    for (Index i = 0; i < rows; ++i) {
      const auto at = static_cast<size_t>(i);
      residuals[i] = nist.y[at] - nist.model(nist.x[at], b, row);
      if (slopes != nullptr) slopes->row(i) = row.transpose();
    }
  };
  std::vector<inference::Parameter> parameters;
  for (const double value : p.start) parameters.push_back({"b", "", value});
  p.model = std::make_shared<inference::ResidualModel>(parameters, p.residuals);
  return p;
}

// Curve of a cell, current from voltage: I = I_L − I₀ (e^{(V + I R_s)/a} − 1) − G (V + I R_s).
// Parameters are the photocurrent and the logarithms of the others. The "measured" curve has 0.1 %
// of noise.
NistProblem diode() {
  NistProblem p;
  p.name = "diode";
  p.model = [](double voltage, const VectorXd& x, VectorXd& slopes) {
    const double i0 = std::exp(x[1]), a = std::exp(x[2]), rs = std::exp(x[3]), g = std::exp(x[4]);
    double current = x[0];
    double growth = 0.0, divisor = 1.0, junction = 0.0;
    for (int k = 0; k < 60; ++k) {
      const double v = voltage + current * rs;
      growth = std::expm1(std::min(v / a, 500.0));
      junction = i0 * (growth + 1.0) / a;
      divisor = 1.0 + (junction + g) * rs;
      const double off = x[0] - i0 * growth - g * v - current;
      current += off / divisor;
      if (std::abs(off) < 1e-15) break;
    }
    const double v = voltage + current * rs;
    slopes << 1.0, -i0 * growth, junction * v, -(junction + g) * current * rs, -g * v;
    slopes /= divisor;
    return current;
  };
  const VectorXd truth =
      numbers_of({0.76, std::log(3.2e-7), std::log(0.0385), std::log(0.036), std::log(0.0186)});
  NormalNumbers normal{1};
  VectorXd slopes(5);
  for (int i = 0; i < 60; ++i) {
    p.x.push_back(0.0098 * i);
    p.y.push_back(p.model(p.x.back(), truth, slopes) + 0.76e-3 * normal());
  }
  p.starts = {numbers_of(
      {0.7, std::log(0.7) - 22.0, std::log(0.57 / 22.0), std::log(0.015), std::log(0.0125)})};
  return p;
}

// Residuals that represent any forward model. With the information matrix H = Rᵀ R and the gradient
// g, the n residuals R⁻ᵀ g with the derivatives R have the gradient and the information of the
// model; one more residual completes χ². The variables are steps from `start`.
inference::ResidualFunction reduced(std::shared_ptr<const inference::ForwardModel> model,
                                    const VectorXd& start) {
  return [model, start](const VectorXd& step, Index, VectorXd& residuals, MatrixXd* slopes) {
    const Index n = step.size();
    const inference::SumsOfRuns sums =
        inference::evaluate(*model, model->stepped(start, step), {}).sums;
    const MatrixXd R = sums.matrix.dense().llt().matrixU();
    residuals.resize(n + 1);
    residuals.head(n) = R.triangularView<Eigen::Upper>().transpose().solve(sums.gradient);
    residuals[n] = std::sqrt(std::max(0.0, sums.chi2 - residuals.head(n).squaredNorm()));
    if (slopes == nullptr) return;
    *slopes = MatrixXd::Zero(n + 1, n);
    slopes->topRows(n) = R;
  };
}

// Ten minutes of a tabletop platform at five readings per second. Fitted: initial state, centre of
// mass, drag, dipole and gyro bias.
struct Tabletop {
  NominalModel nominal;
  std::vector<Observation> runs;

  Tabletop() {
    AttitudeModel& model = nominal.model;
    model.platform.mass_kg = 7.0;
    model.platform.inertia_kg_m2 = Vec3(0.11, 0.12, 0.19).asDiagonal();
    model.environment.magnetic_field_lab_T = {1e-6, 2.2e-5, -4.2e-5};
    add("static_unbalance", "offset_m", {2e-6, -1e-6, -3e-5}, 1e-5);
    add("bearing_drag", "coefficient_N_m_s", {1e-5}, 1e-5);
    add("magnetic_dipole", "dipole_A_m2", {0.02, -0.01, 0.01}, 0.05);
    add("gyro_bias", "bias_rad_s", {1e-3, -5e-4, 2e-4}, 1e-3);
    observe_truth();
    // The nominal values are zero, as without knowledge of the effects.
    for (Disturbance& d : model.disturbances) {
      for (Parameter& p : d.parameters) p.value = 0.0;
    }
  }

  void add(const std::string& kind, const std::string& key, const std::vector<double>& values,
           double sigma) {
    AttitudeModel& model = nominal.model;
    model.disturbances.push_back(
        make_disturbance_of(kind, {{key, values}}, {model.platform, model.environment}));
    for (Parameter& p : model.disturbances.back().parameters) p.sigma = sigma;
  }

  void observe_truth() {
    const Dynamics dynamics(nominal.model);
    std::vector<double> times_s;
    for (int i = 0; i < 3000; ++i) times_s.push_back(0.2 * i);
    const PlatformState initial = dynamics.initial_state({0.01, -0.01, 0.1});
    const Trajectory truth = propagate(dynamics, initial, times_s, {.tolerance = 1e-10});
    NormalNumbers normal{2};
    Observation seen;
    seen.has_gyro = true;
    for (size_t i = 0; i < times_s.size(); ++i) {
      const PlatformState& state = truth.states[i];
      Vec3 turn, rate = state.rate_body_rad_s + Vec3(1e-3, -5e-4, 2e-4);
      for (int k = 0; k < 3; ++k) {
        turn[k] = seen.noise.of(k).level * normal();
        rate[k] += seen.noise.of(3 + k).level * normal();
      }
      seen.time_s.push_back(times_s[i]);
      seen.attitude.push_back(Quat(Eigen::AngleAxisd(turn.norm(), turn.normalized())) *
                              state.lab_from_body);
      seen.attitude_rows.push_back(1.0);
      seen.gyro_rad_s.push_back(rate);
      seen.gyro_rows.emplace_back(1.0, 1.0, 1.0);
    }
    runs = {seen};
  }

  Problem problem() const {
    const Hypothesis h = nominal_hypothesis(nominal, runs);
    const auto model =
        std::make_shared<const AttitudeForwardModel>(h, runs, std::vector<Free>(), 1e-8);
    Problem p;
    p.model = model;
    p.own_start = model->point_of(h);
    const Index n = model->parameters(p.own_start).size();
    p.start = VectorXd::Zero(n);
    p.residuals = reduced(model, p.own_start);
    p.rows = n + 1;
    return p;
  }
};

double digits(const VectorXd& found, const VectorXd& certified) {
  const double worst = (found - certified).cwiseQuotient(certified).cwiseAbs().maxCoeff();
  return std::isfinite(worst) ? std::min(-std::log10(worst), 11.0) : 0.0;
}

void report(benchmark::State& state, const Problem& p, const VectorXd& found, double chi2) {
  if (p.certified.size() > 0) state.counters["digits"] = digits(found, p.certified);
  state.counters["chi2"] = chi2;
}

void own(benchmark::State& state, const Problem& p) {
  inference::Fit fit;
  for (auto _ : state)
    fit = inference::fit(*p.model, p.own_start, inference::Options::to_rounding());
  state.counters["iterations"] = fit.iterations;
  report(state, p, fit.at, fit.chi2);
}

struct Functor {
  const Problem& p;
  mutable int64_t evaluations = 0;

  int inputs() const { return static_cast<int>(p.start.size()); }
  int values() const { return static_cast<int>(p.rows); }
  int operator()(const VectorXd& x, VectorXd& residuals) const {
    ++evaluations;
    p.residuals(x, 0, residuals, nullptr);
    return residuals.allFinite() ? 0 : -1;
  }
  int df(const VectorXd& x, MatrixXd& jacobian) const {
    VectorXd residuals;
    p.residuals(x, 0, residuals, &jacobian);
    jacobian = -jacobian;
    return 0;
  }
};

void eigen(benchmark::State& state, const Problem& p) {
  VectorXd x;
  Functor functor{p};
  for (auto _ : state) {
    functor.evaluations = 0;
    x = p.start;
    Eigen::LevenbergMarquardt<Functor> lm(functor);
    lm.parameters.ftol = lm.parameters.xtol = 1e-15;
    lm.parameters.maxfev = 2000;
    lm.minimize(x);
  }
  VectorXd residuals;
  functor(x, residuals);
  state.counters["iterations"] = static_cast<double>(functor.evaluations);
  report(state, p, x, residuals.squaredNorm());
}

#ifdef PHOTORQUE_HAS_CERES
class Cost final : public ceres::CostFunction {
 public:
  explicit Cost(const Problem& p) : p_(p) {
    set_num_residuals(static_cast<int>(p.rows));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(p.start.size()));
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const VectorXd at = Eigen::Map<const VectorXd>(x[0], p_.start.size());
    const bool wanted = jacobians != nullptr && jacobians[0] != nullptr;
    VectorXd r;
    MatrixXd slopes;
    p_.residuals(at, 0, r, wanted ? &slopes : nullptr);
    if (!r.allFinite()) return false;
    Eigen::Map<VectorXd>(residuals, p_.rows) = r;
    if (wanted) {
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
          jacobians[0], p_.rows, p_.start.size()) = -slopes;
    }
    return true;
  }

 private:
  const Problem& p_;
};

void ceres_solver(benchmark::State& state, const Problem& p) {
  VectorXd x;
  ceres::Solver::Summary summary;
  for (auto _ : state) {
    x = p.start;
    ceres::Problem problem;
    problem.AddResidualBlock(new Cost(p), nullptr, x.data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 2000;
    options.function_tolerance = options.parameter_tolerance = options.gradient_tolerance = 1e-16;
    options.logging_type = ceres::SILENT;
    ceres::Solve(options, &problem, &summary);
  }
  state.counters["iterations"] = static_cast<double>(summary.iterations.size());
  report(state, p, x, 2.0 * summary.final_cost);
}
#endif

void add(const std::string& name, const Problem& problem, benchmark::TimeUnit unit) {
  const auto p = std::make_shared<const Problem>(problem);
  const auto with = [&](const char* solver, void (*run)(benchmark::State&, const Problem&)) {
    const std::string full = name + "/" + solver;
    benchmark::RegisterBenchmark(full.c_str(), [p, run](benchmark::State& s) {
      run(s, *p);
    })->Unit(unit);
  };
  with("own", own);
  with("Eigen", eigen);
#ifdef PHOTORQUE_HAS_CERES
  with("Ceres", ceres_solver);
#endif
}

}  // namespace
}  // namespace photorque

int main(int count, char** arguments) {
  using namespace photorque;
  for (const NistProblem& nist : {misra1a(), mgh17(), thurber()}) {
    for (const size_t start : {0u, 1u}) {
      add(nist.name + " start " + std::to_string(start + 1), problem_of(nist, start),
          benchmark::kMicrosecond);
    }
  }
  add("diode", problem_of(diode(), 0), benchmark::kMicrosecond);
  const Tabletop tabletop;
  add("trajectory", tabletop.problem(), benchmark::kMillisecond);
  benchmark::Initialize(&count, arguments);
  benchmark::RunSpecifiedBenchmarks();
}
