#include "attitude/propagation/place.h"

#include <algorithm>

namespace photorque {

void read_initial_place(const Settings& settings, const AttitudeModel& model,
                        PlatformState& initial) {
  const int place = Dynamics(model).first_of_translation();
  if (place < 0) return;
  auto to = initial.extra.begin() + (place - component::extra);
  for (const char* key : {"initial_position_m", "initial_velocity_m_s"}) {
    const std::vector<double> two =
        settings.has(key) ? settings.numbers(key) : std::vector<double>{0.0, 0.0};
    if (two.size() != 2) {
      throw settings.error(key, std::to_string(two.size()) + " numbers", "two, along lab x and y");
    }
    to = std::copy(two.begin(), two.end(), to);
  }
}

std::optional<std::array<double, 4>> place_of(const Dynamics& dynamics,
                                              const std::vector<double>& y) {
  const int place = dynamics.first_of_translation();
  if (place < 0) return std::nullopt;
  std::array<double, 4> four{};
  std::copy_n(y.begin() + place, 4, four.begin());
  return four;
}

}  // namespace photorque
