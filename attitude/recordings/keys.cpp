#include "attitude/recordings/keys.h"

namespace photorque {

Key recording_table() {
  using namespace recording_key;
  return recording.of({columns, angle_sequence, remove_outliers});
}

}  // namespace photorque
