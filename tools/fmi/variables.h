// What goes into a co-simulation unit and what comes out: names, units, places.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "attitude/propagation/live.h"
#include "attitude/recordings/sensors.h"

namespace photorque {

struct UnitVariable {
  enum class Kind { time, input, output, flag };
  uint32_t reference = 0;  // the standard's handle
  std::string name;        // as the columns of recording.csv and time_history.csv
  Kind kind = Kind::output;
  std::string unit;  // of modelDescription.xml; empty: a pure number
  std::string meaning;
};

// References of the standard; outputs follow in the order of UnitOutputs::values.
constexpr uint32_t time_reference = 0, first_input_reference = 1, first_output_reference = 10;

// All of them, but those of instruments that the platform lacks.
std::vector<UnitVariable> unit_variables(const Sensors& sensors);

// The outputs at a tick. Readings that come less often than ticks are held in between.
class UnitOutputs {
 public:
  static constexpr size_t numbers = 17, flags = 2;

  void take(const LiveRow& row);
  // By reference; null where there is no such output.
  const double* number(uint32_t reference) const;
  const bool* flag(uint32_t reference) const;

 private:
  std::array<double, numbers> numbers_{};
  std::array<bool, flags> flags_{};
};

}  // namespace photorque
