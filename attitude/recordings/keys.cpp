#include "attitude/recordings/keys.h"

namespace photorque {

Key recording_table() {
  using namespace recording_key;
  return recording_key::recording.of({columns, angle_sequence, recording_key::remove_outliers});
}

}  // namespace photorque
