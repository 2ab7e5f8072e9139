#include "attitude/filtering/keys.h"

#include "attitude/filtering/study.h"

namespace photorque {

Key estimate_table() {
  const EstimateStudy usual;
  return Key::table(
      "estimate",
      {Key::choice_or("model",
                      {{"disturbances", "the modelled torques"},
                       {"gyro", "the gyro"},
                       {"walk", "a rate that walks"}},
                      0,
                      "what moves the platform between readings in the estimate that is written"),
       Key::number("rate_walk", Range::positive(),
                   "random walk of the rate without torques, rad/s per √s")
           .usually_is("the likeliest"),
       Key::number("disturbed_rate_walk", Range::positive(), "the same beside the modelled torques")
           .usually_is("the likeliest"),
       Key::number_or("rate_sigma_rad_s", usual.filter.rate_sigma_rad_s, Range::positive(),
                      "of the rate before the first reading"),
       Key::integer_or("search_readings", 2000, 50, 100'000'000,
                       "over how many the likeliest is looked for"),
       Key::integer_or("runs", usual.runs, 0, 100'000,
                       "simulated for the consistency, where there is no recording")},
      "how the attitude is estimated");
}

}  // namespace photorque
