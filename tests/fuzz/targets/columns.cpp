// Fuzz target: any bytes as a table of numbers, and as measured values over time.
#include "core/text/parse.h"

#include "attitude/environment/time_series.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  const fuzz::FileInMemory file(data, size);
  fuzz::may_refuse([&] { read_number_columns(file.path(), read_column_names(file.path())); });
  fuzz::may_refuse([&] {
    read_time_series(file.path(), {"x_T", "y_T", "z_T"}, TimeSeries::Outside::hold).at(1.5);
  });
  return 0;
}
