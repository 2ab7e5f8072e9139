// A domain in which every step of the search has a closed form: readings along a line, to which
// terms may be missing that are linear in their amplitudes, and Gaussian noise of one.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <limits>

#include "inference/domain.h"
#include "inference/whiteness.h"
#include "tests/noise.h"

namespace photorque::inference::line {

struct Series {
  Eigen::VectorXd x, y;
  double sign = 1.0;  // how the run was made; some terms depend on it
};

// Columns of a term along a run, one for each amplitude; `searched` enters nonlinearly.
using Shape = std::function<Eigen::MatrixXd(const Series& run, double searched)>;

struct Term {
  CandidateTraits traits;
  Shape shape;
  std::vector<double> grid = {0.0};  // on which `searched` is scanned
  bool not_negative = false;
};

// Amplitudes of terms are in units of a column's noise; before looking they are N(0, 30²), and the
// prior odds of each term are 1 : 30.
constexpr double amplitude_sigma = 30.0, log_prior = -3.4;
// The nominal model's slope is 0 ± this.
constexpr double slope_sigma = 10.0;

struct LineFit : Fit {
  Eigen::VectorXd value;        // intercept of each run, slope, amplitudes
  Eigen::MatrixXd information;  // of them, with the priors
  // The effect of the errors of the amplitudes on the held-out runs is not predicted.
  LineFit() {
    hessian = ArrowMatrix(0, 0, 1);
    hessian.add_to_diagonal(0, std::numeric_limits<double>::quiet_NaN());
  }
};

class LineDomain {
 public:
  using Run = Series;
  using Begin = double;  // the intercept of a run; a linear fit may begin anywhere
  struct Start {
    double searched = 0.0;
    double gain = std::numeric_limits<double>::infinity();
  };
  struct Trial : Explanation {
    std::vector<double> searched;
    LineFit fit;
  };
  using Runs = std::vector<Series>;

  LineDomain(std::vector<Term> terms, Thresholds thresholds)
      : limits(std::move(thresholds)), terms_(std::move(terms)) {
    for (const Term& t : terms_) list.push_back(t.traits);
  }

  Trial nominal(const Runs& runs) const { return fitted({}, runs); }

  std::vector<CandidateTraits> list;
  Thresholds limits;

  Start start_of(size_t c) const { return {terms_[c].grid.front()}; }

  Trial extend(const Trial& parent, size_t c, const Start& start, const Runs& runs,
               const Effort&) const {
    return fitted(with(parent, c, start.searched), runs);
  }
  Trial refit(const Trial& t, const Runs& runs, const std::vector<Begin>&, const Effort&) const {
    return fitted(t, runs);
  }
  Trial refit_near(const Trial& t, const Trial&, const Runs& runs, const Effort&) const {
    return fitted(t, runs);
  }
  // Only the intercepts are fitted.
  Trial predict(const Trial& t, const Runs& runs) const {
    Trial predicted = t;
    predicted.fit.data_chi2 = 0.0;
    predicted.fit.samples = 0;
    for (const Series& run : runs) {
      const Eigen::MatrixXd J = columns(t, {run});
      Eigen::VectorXd left = run.y - J.rightCols(J.cols() - 1) * t.fit.value.tail(J.cols() - 1);
      left.array() -= left.mean();
      predicted.fit.data_chi2 += left.squaredNorm();
      predicted.fit.samples += left.size();
    }
    predicted.fit.chi2 = predicted.fit.data_chi2;
    return predicted;
  }
  std::vector<Begin> initial_conditions_of(const Trial& t) const {
    const Eigen::VectorXd& v = t.fit.value;
    return {v.begin(), v.end() - (1 + amplitudes(t))};
  }
  std::vector<Begin> initial_conditions_from_data(const Trial&, const Runs& runs) const {
    std::vector<Begin> begins;
    for (const Series& run : runs) begins.push_back(run.y[0]);
    return begins;
  }
  Trial with_initial_conditions(Trial t, const std::vector<Begin>& begins) const {
    const auto intercepts = static_cast<Eigen::Index>(begins.size());
    const Eigen::VectorXd shared = t.fit.value.tail(1 + amplitudes(t));
    t.fit.value.resize(intercepts + shared.size());
    t.fit.value << Eigen::Map<const Eigen::VectorXd>(begins.data(), intercepts), shared;
    return t;
  }

  // For a linear model, the score test is the difference of two fits without priors of the new
  // terms.
  std::vector<double> gains(const Trial& at, const std::vector<size_t>& which,
                            const Runs& runs) const {
    std::vector<double> result;
    const double before = solve(at, runs, 0).chi2;
    for (const size_t c : which) {
      const bool linear = terms_[c].traits.is_linear;
      const Trial more = with(at, c, terms_[c].grid.front());
      result.push_back(linear ? before - solve(more, runs, 1).chi2 : 0.0);
    }
    return result;
  }
  std::vector<inference::Term<Start>> terms_of(const Trial& t) const {
    std::vector<inference::Term<Start>> terms;
    for (size_t i = 0; i < t.candidates.size(); ++i) {
      terms.push_back({t.candidates[i], {t.searched[i]}});
    }
    return terms;
  }
  // The columns of all terms, intercepts and slope projected out.
  LinearProblem linear_problem(const Trial& at, const std::vector<inference::Term<Start>>& terms,
                               const Runs& runs) const {
    Trial all;
    LinearProblem problem;
    Eigen::Index first = 0, own = at.fit.value.size() - amplitudes(at);
    for (size_t i = 0; i < terms.size(); ++i) {
      const Term& t = terms_[terms[i].candidate];
      const auto count = static_cast<Eigen::Index>(t.traits.parameters);
      if (t.traits.is_fast) {
        if (i < at.candidates.size()) own += count;
        continue;
      }
      StrengthGroup group{i, t.traits.name, t.traits.is_empirical, first, {}, {}, {}, {}};
      for (Eigen::Index k = 0; k < count; ++k) {
        group.value.push_back(i < at.candidates.size() ? at.fit.value[own++] : 0.0);
        group.scale.push_back(amplitude_sigma);
        group.lowest.push_back(t.not_negative ? 0.0 : -1e300);
        group.highest.push_back(1e300);
      }
      first += count;
      problem.groups.push_back(std::move(group));
      all = with(all, terms[i].candidate, terms[i].start.searched);
    }
    const LineFit fit = solve(all, runs, all.candidates.size());
    const Eigen::Index rest = fit.value.size() - first;
    const Eigen::MatrixXd& H = fit.information;
    problem.information =
        H.bottomRightCorner(first, first) -
        H.bottomLeftCorner(first, rest) *
            H.topLeftCorner(rest, rest).ldlt().solve(H.topRightCorner(rest, first));
    Eigen::VectorXd value(first);
    for (const StrengthGroup& g : problem.groups) {
      for (Eigen::Index k = 0; k < g.count(); ++k)
        value[g.first + k] = g.value[static_cast<size_t>(k)];
    }
    problem.gradient = problem.information * (fit.value.tail(first) - value);
    return problem;
  }
  Trial assemble(const Trial&, const Members<Start>& members, const Runs& runs,
                 const Effort&) const {
    Trial t;
    for (const auto& m : members) t = with(t, m.term.candidate, m.term.start.searched);
    return fitted(t, runs);
  }
  std::vector<std::vector<Start>> starts(const Trial& parent, const std::vector<size_t>& which,
                                         const Runs& runs, const Runs&, int) const {
    std::vector<std::vector<Start>> result;
    for (const size_t c : which) {
      if (terms_[c].traits.is_linear) {
        result.push_back({start_of(c)});
        continue;
      }
      const double before = solve(parent, runs, 0).chi2;
      Start best{0.0, -1.0};
      for (const double searched : terms_[c].grid) {
        const double gain = before - solve(with(parent, c, searched), runs, 1).chi2;
        if (gain > best.gain) best = {searched, gain};
      }
      result.push_back({});
      if (best.gain > limits.scoring.min_scan_gain) result.back().push_back(best);
    }
    return result;
  }

  // Runs are short: nothing is averaged.
  Runs average(const Trial&, const Runs& runs, size_t) const { return runs; }
  Runs cut(const Runs& runs, size_t pieces) const {
    Runs result;
    for (const Series& run : runs) {
      const auto n = static_cast<size_t>(run.x.size());
      for (size_t i = 0; i < pieces; ++i) {
        const auto first = static_cast<Eigen::Index>(i * n / pieces);
        const auto count = static_cast<Eigen::Index>((i + 1) * n / pieces) - first;
        if (static_cast<size_t>(count) < limits.search.min_readings_of_piece) continue;
        result.push_back({run.x.segment(first, count), run.y.segment(first, count), run.sign});
      }
    }
    return result;
  }
  double excess_sigma(const Trial& t, const Runs& runs) const {
    std::vector<ChannelResiduals> all;
    const Eigen::VectorXd left = readings(runs) - columns(t, runs) * t.fit.value;
    Eigen::Index first = 0;
    for (const Series& run : runs) {
      all.push_back({{left.begin() + first, left.begin() + first + run.x.size()}});
      first += run.x.size();
    }
    return whiteness(all, limits.noise).excess_sigma;
  }

 private:
  static Trial with(const Trial& parent, size_t c, double searched) {
    Trial t = parent;
    t.candidates.push_back(c);
    t.searched.push_back(searched);
    return t;
  }

  Eigen::Index amplitudes(const Trial& t) const {
    size_t count = 0;
    for (const size_t c : t.candidates) count += terms_[c].traits.parameters;
    return static_cast<Eigen::Index>(count);
  }

  static Eigen::VectorXd readings(const Runs& runs) {
    Eigen::Index n = 0;
    for (const Series& run : runs) n += run.x.size();
    Eigen::VectorXd y(n);
    Eigen::Index first = 0;
    for (const Series& run : runs) {
      y.segment(first, run.y.size()) = run.y;
      first += run.y.size();
    }
    return y;
  }

  Eigen::MatrixXd columns(const Trial& t, const Runs& runs) const {
    Eigen::MatrixXd J;
    Eigen::Index first = 0;
    for (size_t r = 0; r < runs.size(); ++r) {
      const Series& run = runs[r];
      const auto intercepts = static_cast<Eigen::Index>(runs.size());
      Eigen::MatrixXd own = Eigen::MatrixXd::Zero(run.x.size(), intercepts + 1);
      own.col(static_cast<Eigen::Index>(r)).setOnes();
      own.col(intercepts) = run.x;
      for (size_t i = 0; i < t.candidates.size(); ++i) {
        const Eigen::MatrixXd shape = terms_[t.candidates[i]].shape(run, t.searched[i]);
        own.conservativeResize(Eigen::NoChange, own.cols() + shape.cols());
        own.rightCols(shape.cols()) = shape;
      }
      J.conservativeResize(first + own.rows(), own.cols());
      J.bottomRows(own.rows()) = own;
      first += own.rows();
    }
    return J;
  }

  // The last `flat` of the candidates without their priors.
  LineFit solve(const Trial& t, const Runs& runs, size_t flat) const {
    const Eigen::MatrixXd J = columns(t, runs);
    const Eigen::VectorXd y = readings(runs);
    const auto intercepts = static_cast<Eigen::Index>(runs.size());
    Eigen::VectorXd prior = Eigen::VectorXd::Zero(J.cols());
    prior[intercepts] = 1.0 / (slope_sigma * slope_sigma);
    Eigen::Index at = intercepts + 1;
    for (size_t i = 0; i < t.candidates.size(); ++i) {
      const auto own = static_cast<Eigen::Index>(terms_[t.candidates[i]].traits.parameters);
      const bool is_flat = i + flat >= t.candidates.size();
      prior.segment(at, own).setConstant(is_flat ? 0.0 : std::pow(amplitude_sigma, -2));
      at += own;
    }
    LineFit fit;
    fit.information = J.transpose() * J;
    fit.information.diagonal() += prior;
    fit.value = fit.information.ldlt().solve(Eigen::VectorXd(J.transpose() * y));
    fit.data_chi2 = (y - J * fit.value).squaredNorm();
    fit.chi2 = fit.data_chi2 + fit.value.dot(prior.asDiagonal() * fit.value);
    fit.samples = y.size();
    return fit;
  }

  Trial fitted(Trial t, const Runs& runs) const {
    t.fit = solve(t, runs, 0);
    t.log_evidence =
        -0.5 * t.fit.chi2 - 0.5 * t.fit.information.ldlt().vectorD().array().log().sum();
    t.significance.clear();
    t.objection.clear();
    const Eigen::MatrixXd covariance = t.fit.information.ldlt().solve(
        Eigen::MatrixXd::Identity(t.fit.information.rows(), t.fit.information.rows()));
    Eigen::Index at = static_cast<Eigen::Index>(runs.size()) + 1;
    for (const size_t c : t.candidates) {
      const auto own = static_cast<Eigen::Index>(terms_[c].traits.parameters);
      t.log_evidence += log_prior - static_cast<double>(own) * std::log(amplitude_sigma);
      const Eigen::VectorXd theta = t.fit.value.segment(at, own);
      const Eigen::MatrixXd C = covariance.block(at, at, own, own);
      t.significance.push_back(std::sqrt(theta.dot(C.ldlt().solve(theta))));
      if (terms_[c].not_negative && theta.minCoeff() < 0.0) t.objection = "has the wrong sign";
      at += own;
    }
    return t;
  }

  std::vector<Term> terms_;
};

// Polynomials of degree 2, 3, … along [−1, 1] that are orthonormal to each other and to every line,
// on the points of `x`.
inline Eigen::MatrixXd orthonormal_polynomials(const Eigen::VectorXd& x, Eigen::Index count) {
  Eigen::MatrixXd P(x.size(), count + 2);
  for (Eigen::Index k = 0; k < P.cols(); ++k) {
    // The next by the recurrence x P, made orthogonal twice against rounding.
    Eigen::VectorXd next =
        k == 0 ? Eigen::VectorXd::Ones(x.size()).eval() : x.cwiseProduct(P.col(k - 1)).eval();
    for (int twice = 0; twice < 2; ++twice) {
      next -= P.leftCols(k) * (P.leftCols(k).transpose() * next).eval();
    }
    P.col(k) = next.normalized();
  }
  return P.rightCols(count);
}

inline Eigen::VectorXd grid(Eigen::Index n) {
  return Eigen::VectorXd::LinSpaced(n, -1.0, 1.0);
}

constexpr Eigen::Index samples = 200;  // of a whole run

// Columns on the points of a whole run, taken where this one has its own: a piece of a run sees a
// piece of the same function.
inline Eigen::MatrixXd taken_at(const Eigen::MatrixXd& whole, const Series& run) {
  const double step = 2.0 / static_cast<double>(samples - 1);
  const Eigen::Index first = std::lround((run.x[0] + 1.0) / step);
  return whole.middleRows(first, run.x.size());
}

inline Term polynomial(Eigen::Index degree) {
  Term t;
  t.traits = {"degree " + std::to_string(degree), false, true, false, true, 1};
  t.shape = [degree](const Series& run, double) -> Eigen::MatrixXd {
    return taken_at(orthonormal_polynomials(grid(samples), degree - 1).rightCols(1), run);
  };
  return t;
}

// Sine and cosine of a frequency that is scanned.
inline Term tone() {
  Term t;
  t.traits = {"tone", false, false, true, true, 2};
  t.grid.clear();
  for (int k = 8; k <= 60; ++k) t.grid.push_back(k);
  t.shape = [](const Series& run, double periods) {
    Eigen::MatrixXd columns(run.x.size(), 2);
    const Eigen::ArrayXd phase = 3.14159265358979 * periods * run.x.array();
    columns << phase.sin().matrix(), phase.cos().matrix();
    return Eigen::MatrixXd(columns * std::sqrt(2.0 / static_cast<double>(samples)));
  };
  return t;
}

// A slow part that equals a polynomial, and a ringing of a scanned frequency. The degree follows
// the frequency.
inline Term swing() {
  Term t = tone();
  t.traits.name = "swing";
  t.traits.parameters = 1;
  t.traits.most = 2;
  t.shape = [](const Series& run, double periods) -> Eigen::MatrixXd {
    constexpr double ringing = 0.35;
    const Eigen::Index degree = 2 + std::lround(periods) % 6;
    const Eigen::VectorXd slow = polynomial(degree).shape(run, 0.0),
                          fast = tone().shape(run, periods).col(0);
    return std::sqrt(1.0 - ringing * ringing) * slow + ringing * fast;
  };
  return t;
}

// A smooth function without a law: bumps side by side.
inline Term smooth(Eigen::Index bumps) {
  Term t;
  t.traits = {"smooth", true, true, false, true, static_cast<size_t>(bumps)};
  t.shape = [bumps](const Series& run, double) -> Eigen::MatrixXd {
    const Eigen::VectorXd x = grid(samples);
    const double width = 1.0 / static_cast<double>(bumps);
    Eigen::MatrixXd columns(samples, bumps);
    for (Eigen::Index b = 0; b < bumps; ++b) {
      const double middle = -1.0 + (2.0 * static_cast<double>(b) + 1.0) * width;
      columns.col(b) = (-(x.array() - middle).square() / (2.0 * width * width)).exp().matrix();
      columns.col(b).normalize();
    }
    return taken_at(columns, run);
  };
  return t;
}

// Noise along a separate line, with `signal` added.
inline Series recorded(uint64_t seed, const Eigen::VectorXd& signal, double sign = 1.0) {
  Noise normal(seed);
  Series run{grid(signal.size()), signal, sign};
  const double intercept = 3.0 * normal();
  for (Eigen::Index i = 0; i < signal.size(); ++i) {
    run.y[i] += intercept + 0.5 * run.x[i] + normal();
  }
  return run;
}

}  // namespace photorque::inference::line
