// Fuzz target: any bytes as a table of light over attitude that an earlier run kept.
#include "core/rotations/table.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  RotationTable table;
  if (!table.read(fuzz::text_of(data, size))) return 0;
  if (table.channels() == 0 || table.channels() > 1000) return 0;
  std::vector<double> values(table.channels());
  try {
    table.at(Quat::Identity(), 0, values);
    table.at(Quat(0.9, 0.1, -0.2, 0.3).normalized(), 0, values);
  } catch (const NumericalError&) {
    // Beyond the angles that it was made for.
  }
  return 0;
}
