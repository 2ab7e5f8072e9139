// [estimate], which study.cpp reads.
#pragma once

#include <vector>

#include "attitude/filtering/motion_model.h"
#include "core/settings/typed_keys.h"

namespace photorque {

namespace estimate_key {
inline constexpr ChoiceKey model("model",
                                 {{"disturbances", "the modelled torques"},
                                  {"gyro", "the gyro"},
                                  {"walk", "a random walk of the rate"}},
                                 0, "motion model between the readings of the written estimate");
inline constexpr NumberKey rate_walk("rate_walk", Range::positive(),
                                     "random walk of the rate without torques, rad/s per √s",
                                     {.usually = "of maximum likelihood"});
inline constexpr NumberKey disturbed_rate_walk("disturbed_rate_walk", Range::positive(),
                                               "likewise, in addition to the modelled torques",
                                               {.usually = "of maximum likelihood"});
inline constexpr NumberKey rate_sigma("rate_sigma_rad_s", FilterSettings{}.rate_sigma_rad_s,
                                      Range::positive(),
                                      "standard deviation of the rate before the first reading");
inline constexpr IntegerKey search_readings("search_readings", 2000, 50, 100'000'000,
                                            "number of readings for the maximum-likelihood search");
inline constexpr IntegerKey runs(
    "runs", 20, 0, 100'000,
    "number of simulated runs for the consistency test, if no recording is given");
inline constexpr TableKey estimate("estimate", "how the attitude is estimated");
}  // namespace estimate_key
Key estimate_table();

}  // namespace photorque
