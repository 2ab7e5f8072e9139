#include "diagnosis/attitude/gyro_bias.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "attitude/observation/bias_history.h"
#include "diagnosis/attitude/holdout.h"
#include "diagnosis/attitude/sentences.h"

namespace photorque {
namespace {

// The farthest that the bias goes from its mean, an axis each.
void say_drift(const BiasHistory& history, std::vector<InstrumentFinding>& findings) {
  const std::string name = std::filesystem::path(history.recording).filename().string();
  for (int axis = 0; axis < 3; ++axis) {
    size_t at = 0;
    for (size_t k = 1; k < history.time_s.size(); ++k) {
      if (std::abs(history.bias_rad_s[k][axis]) > std::abs(history.bias_rad_s[at][axis])) at = k;
    }
    const double off = history.bias_rad_s[at][axis], sigma = history.sigma_rad_s[at][axis];
    findings.push_back(
        {channel_traits(3 + axis).name, "bias_drift_rad_s", off, sigma,
         written("the bias of the gyro about body %c drifts: in %s it is (%.3g ± %.1g) rad/s off "
                 "its mean at %.0f s; the drift is taken out",
                 'x' + axis, name.c_str(), off, sigma, history.time_s[at])});
  }
}

}  // namespace

void take_out_bias_drift(RecordedData& data) {
  std::vector<const Observation*> pieces;
  for (const auto* runs : {&data.train, &data.held}) {
    for (const Observation& seen : *runs) pieces.push_back(&seen);
  }
  for (const BiasHistory& history : bias_histories(pieces)) {
    for (auto* runs : {&data.train, &data.held}) {
      for (Observation& seen : *runs) {
        if (seen.name != history.recording) continue;
        for (size_t i = 0; i < seen.blocks(); ++i) {
          seen.gyro_rad_s[i] -= history.at(seen.time_s[i]);
        }
      }
    }
    say_drift(history, data.instruments);
  }
}

}  // namespace photorque
