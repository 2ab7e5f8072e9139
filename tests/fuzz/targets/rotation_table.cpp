// Fuzz target: any bytes as a table of light over attitude that an earlier run kept.
#include "core/numerics/table.h"

#include <array>

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  RotationTable table;
  const std::string bytes = fuzz::text_of(data, size);
  if (!table.read(bytes)) return 0;
  if (table.bytes() != bytes) std::abort();
  if (table.channels() > 1000) return 0;
  std::vector<double> values(table.channels()), slopes(4 * table.channels());
  for (const Quat& attitude :
       {Quat::Identity(), Quat(0.9, 0.1, -0.2, 0.3).normalized(), Quat(0, 1, 0, 0)}) {
    try {
      table.at(attitude, 0, values);
      table.at(attitude, 0, values, slopes);
      std::array<double, 1> one{};
      table.only(table.channels() - 1, 1).at(attitude, 0, one);
    } catch (const NumericalError&) {
      // Beyond the angles that it was made for.
    }
  }
  return 0;
}
