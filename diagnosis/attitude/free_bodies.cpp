#include "diagnosis/attitude/findings.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <filesystem>
#include <map>

#include "attitude/estimation/free_inertia.h"
#include "core/text/format.h"

namespace photorque {
namespace {

// Limits in units of the mean moment, except for `least_sigma` [standard errors].
constexpr double least_difference = 0.1, most_error = 0.05, least_sigma = 5.0;

std::string file_name_of(const std::string& recording) {
  return std::filesystem::path(recording).filename().string();
}

struct OneRecording {
  std::string name;
  FreeInertia inertia;
};

std::vector<OneRecording> each_alone(const RecordedData& data) {
  std::map<std::string, std::vector<Observation>> pieces;
  std::vector<std::string> order;
  for_each_run(data, [&](const Observation& seen) {
    auto& own = pieces[seen.name];
    if (own.empty()) order.push_back(seen.name);
    own.push_back(seen);
  });
  std::vector<OneRecording> all;
  for (const std::string& name : order) {
    const std::optional<FreeInertia> found = free_inertia(pieces.at(name));
    const auto is_known = [&] {
      return found->sigma(0) < most_error && found->sigma(1) < most_error &&
             found->sigma(2) < most_error;
    };
    if (found && is_known()) all.push_back({name, *found});
  }
  return all;
}

bool differ(const FreeInertia& a, const FreeInertia& b) {
  for (int k = 0; k < 6; ++k) {
    const double by = std::abs(a.value[k] - b.value[k]);
    if (by > least_difference && by > least_sigma * std::hypot(a.sigma(k), b.sigma(k))) return true;
  }
  return false;
}

// Group number of each recording. Recordings that are indistinguishable, directly or through
// others, have equal numbers.
std::vector<size_t> groups_of(const std::vector<OneRecording>& all) {
  std::vector<size_t> group(all.size());
  for (size_t i = 0; i < all.size(); ++i) group[i] = i;
  for (size_t i = 0; i < all.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (differ(all[i].inertia, all[j].inertia)) continue;
      const size_t from = std::max(group[i], group[j]), to = std::min(group[i], group[j]);
      std::replace(group.begin(), group.end(), from, to);
    }
  }
  return group;
}

// Mean weighted by the errors of the recordings, with errors widened to the scatter.
BodyOfRecordings body_of(const std::vector<const OneRecording*>& members) {
  BodyOfRecordings body;
  for (const OneRecording* one : members) body.recordings.push_back(one->name);
  for (int k = 0; k < 6; ++k) {
    double weight = 0.0, sum = 0.0, chi2 = 0.0;
    for (const OneRecording* one : members) {
      const double w = std::pow(one->inertia.sigma(k), -2.0);
      weight += w;
      sum += w * one->inertia.value[k];
    }
    for (const OneRecording* one : members) {
      chi2 += std::pow((one->inertia.value[k] - sum / weight) / one->inertia.sigma(k), 2.0);
    }
    const auto freedom = static_cast<double>(members.size() - 1);
    const double wider = freedom > 0.0 ? std::max(1.0, std::sqrt(chi2 / freedom)) : 1.0;
    body.inertia_relative.push_back(sum / weight);
    body.inertia_relative_sigma.push_back(wider / std::sqrt(weight));
  }
  return body;
}

Vec3 principal_moments(const std::vector<double>& i) {
  Mat3 inertia;
  inertia << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
  return Eigen::SelfAdjointEigenSolver<Mat3>(inertia).eigenvalues();
}

// Residual of free motion (free_inertia.h) with all rates multiplied by a factor; infinite if the
// rates determine no inertia.
double left_by(double factor, std::vector<Observation> pieces) {
  for (Observation& seen : pieces) {
    for (Vec3& rate : seen.gyro_rad_s) rate *= factor;
  }
  const auto found = free_inertia(pieces);
  return found ? found->left : INFINITY;
}

struct Factor {
  double value = 1.0, left = INFINITY;
};

// Minimum over factors from 0.3 to 3: grid search, then golden section.
Factor best_factor(const std::vector<Observation>& pieces) {
  constexpr double widest = 1.1, step = 0.1;  // in the logarithm of the factor
  double best = 0.0, least = INFINITY;
  for (double log = -widest; log < widest + 0.5 * step; log += step) {
    const double left = left_by(std::exp(log), pieces);
    if (left < least) {
      least = left;
      best = log;
    }
  }
  constexpr double section = 0.3819660112501051;
  double low = best - step, high = best + step;
  for (int i = 0; i < 16; ++i) {
    const double a = low + section * (high - low), b = high - section * (high - low);
    const bool is_below = left_by(std::exp(a), pieces) < left_by(std::exp(b), pieces);
    (is_below ? high : low) = is_below ? b : a;
  }
  const double log = 0.5 * (low + high);
  return {std::exp(log), left_by(std::exp(log), pieces)};
}

}  // namespace

std::vector<BodyOfRecordings> different_bodies(const Platform& platform, const RecordedData& data) {
  if (platform.has_bearing()) return {};
  const std::vector<OneRecording> all = each_alone(data);
  const std::vector<size_t> group = groups_of(all);
  std::vector<BodyOfRecordings> bodies;
  for (size_t first = 0; first < all.size(); ++first) {
    if (group[first] != first) continue;
    std::vector<const OneRecording*> members;
    for (size_t i = first; i < all.size(); ++i) {
      if (group[i] == first) members.push_back(&all[i]);
    }
    bodies.push_back(body_of(members));
  }
  return bodies.size() > 1 ? bodies : std::vector<BodyOfRecordings>{};
}

std::string sentence_of(const std::vector<BodyOfRecordings>& bodies) {
  if (bodies.empty()) return "";
  const auto number = [](double x) { return readable_number(x, 3); };
  std::string text =
      "different bodies: the recordings do not agree with one body in one mounting. ";
  for (const BodyOfRecordings& body : bodies) {
    text += joined_text(body.recordings, ", ", file_name_of) + ": Ixx, Iyy, Izz are ";
    for (size_t k = 0; k < 3; ++k) {
      text += (k > 0 ? ", " : "") + number(body.inertia_relative[k]) + " ± " +
              number(body.inertia_relative_sigma[k]);
    }
    text += " of their mean; ";
  }
  const Vec3 a = principal_moments(bodies[0].inertia_relative),
             b = principal_moments(bodies[1].inertia_relative);
  const bool is_turned = bodies.size() == 2 && (a - b).cwiseAbs().maxCoeff() < least_difference;
  return text + (is_turned ? "their principal moments agree: the mounting of the sensor may have "
                             "changed; diagnose the recordings separately"
                           : "diagnose them apart");
}

std::vector<InstrumentFinding> clock_findings(const Platform& platform, const RecordedData& data) {
  if (platform.has_bearing()) return {};
  constexpr size_t most_rows = 400;
  std::map<std::string, std::vector<Observation>> pieces;
  bool sees_attitude = false;
  for_each_run(data, [&](const Observation& seen) {
    sees_attitude = sees_attitude || seen.has_some_attitude();
    pieces[seen.name].push_back(seen.averaged(most_rows));
  });
  if (sees_attitude) return {};
  constexpr double least_change = 0.05, better = 1.0 / 3.0, good = 0.05;
  std::vector<InstrumentFinding> findings;
  for (const auto& [name, own] : pieces) {
    const double as_read = left_by(1.0, own);
    const Factor best = best_factor(own);
    if (!(best.left < good) || !(best.left < better * as_read) ||
        std::abs(best.value - 1.0) < least_change) {
      continue;
    }
    findings.push_back(
        {"time", "clock_factor", best.value, 0.0,
         printed("%s: rates and clock are inconsistent: only with rates %.3g times as large, or "
                 "times %.3g times as long, do the rates change as any inertia makes them",
                 file_name_of(name).c_str(), best.value, best.value)});
  }
  return findings;
}

}  // namespace photorque
