#include "attitude/studies/keys.h"

#include "attitude/disturbances/mass/moving_masses.h"

namespace photorque {

Key balance_table() {
  return Key::table("balance", moving_mass_keys(), "the masses that balance the platform");
}

}  // namespace photorque
