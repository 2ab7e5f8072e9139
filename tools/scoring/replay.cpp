#include "tools/scoring/replay.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "attitude/injection/vectors.h"
#include "attitude/recordings/recording.h"
#include "core/constants.h"

namespace photorque {
namespace {

using namespace injected;

struct Attitudes {
  std::vector<double> time_s;
  std::vector<Quaternion> lab_from_body;
};

Attitudes attitudes_of(const std::filesystem::path& file) {
  const Recording recording = read_recording(file);
  Attitudes all;
  const char* const names[] = {"q_w", "q_x", "q_y", "q_z"};
  const Channel* channels[4];
  for (size_t k = 0; k < 4; ++k) {
    channels[k] = recording.find(names[k]);
    if (channels[k] == nullptr) return all;
  }
  for (size_t i = 0; i < recording.rows(); ++i) {
    Quaternion q;
    for (size_t k = 0; k < 4; ++k) q[k] = channels[k]->values[i];
    if (std::isnan(q[0] + q[1] + q[2] + q[3])) continue;
    all.time_s.push_back(recording.time_s[i]);
    all.lab_from_body.push_back(normalised(q));
  }
  return all;
}

// Between two rows the rate is taken as constant.
Quaternion at(const Attitudes& replay, double time_s) {
  const auto next = std::ranges::lower_bound(replay.time_s, time_s);
  const auto i = static_cast<size_t>(next - replay.time_s.begin());
  if (i == 0) return replay.lab_from_body[0];
  const Quaternion &a = replay.lab_from_body[i - 1], &b = replay.lab_from_body[i];
  const double part = (time_s - replay.time_s[i - 1]) / (replay.time_s[i] - replay.time_s[i - 1]);
  return product(quaternion_of(times(part, turn_of(product(b, conjugate(a))))), a);
}

}  // namespace

std::array<double, 3> found_noise_arcsec(const nlohmann::json& diagnosis,
                                         std::array<double, 3> stated) {
  const std::array<std::string, 3> names = {"attitude_x_arcsec", "attitude_y_arcsec",
                                            "attitude_z_arcsec"};
  for (const auto& finding : diagnosis.value("instruments", nlohmann::json::array())) {
    if (finding.value("what", "") != "noise_level" || !finding.at("value").is_number()) continue;
    const auto name = std::ranges::find(names, finding.value("channel", ""));
    if (name != names.end()) stated[static_cast<size_t>(name - names.begin())] = finding["value"];
  }
  return stated;
}

double replayed_chi2(const std::filesystem::path& recorded, const std::filesystem::path& propagated,
                     const std::array<double, 3>& noise_arcsec) {
  constexpr double arcsecond = pi / 180.0 / 3600.0;
  constexpr double median_of_normal = 0.454936;  // of the square
  const Attitudes read = attitudes_of(recorded), replay = attitudes_of(propagated);
  std::array<std::vector<double>, 3> squares;
  for (size_t i = 0; i < read.time_s.size(); ++i) {
    if (replay.time_s.empty() || read.time_s[i] > replay.time_s.back()) break;
    const Quaternion there = at(replay, read.time_s[i]);
    const Triple off = turn_of(product(read.lab_from_body[i], conjugate(there)));
    for (size_t k = 0; k < 3; ++k) {
      squares[k].push_back(std::pow(off[k] / (noise_arcsec[k] * arcsecond), 2));
    }
  }
  double sum = 0.0;
  for (std::vector<double>& axis : squares) {
    if (axis.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = axis.begin() + static_cast<ptrdiff_t>(axis.size() / 2);
    std::ranges::nth_element(axis, middle);
    sum += *middle / median_of_normal / 3.0;
  }
  return sum;
}

}  // namespace photorque
