#include "attitude/filtering/keys.h"

namespace photorque {

Key estimate_table() {
  using namespace estimate_key;
  return estimate.of({model, rate_walk, disturbed_rate_walk, rate_sigma, search_readings, runs});
}

}  // namespace photorque
