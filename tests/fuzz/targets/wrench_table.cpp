// Fuzz target: any bytes as a table of torque over attitude; the surface through it, looked up.
#include "attitude/disturbances/fields/torque_surface.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const fuzz::FileInMemory file(data, size);
  fuzz::may_refuse([&] {
    const WrenchTable table = read_wrench_table(file.path());
    if (table.torque_body_N_m.size() != table.nodes()) std::abort();
    try {
      const TorqueSurface surface(table);
      for (const TableAngles angles : {TableAngles{0.1, 0.2}, {-0.3, 4.0}, {3.1, -3.1}}) {
        wrench_at(table, angles);
        surface.at(angles);
      }
    } catch (const NumericalError&) {
      // Outside of the table, or one of too few angles.
    }
  });
  return 0;
}
