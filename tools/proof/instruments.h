// What the instruments of an injected case write: noise, faults and lost rows.
#pragma once

#include <string>
#include <vector>

#include "tools/proof/case.h"

namespace photorque::injected {

// When the rows are taken, and which of them are lost.
struct Rows {
  std::vector<double> time_s;
  std::vector<bool> lost;
};
Rows draw_rows(RandomDraw& draw, const InjectedSensors& sensors, double duration_s);

// Three channels of errors in units of their stated level, one after the other.
class Errors {
 public:
  Errors(const InjectedNoise& noise, double interval_s);
  Triple next(RandomDraw& draw);
  // As the instrument reports what it reads in steps of `unit` (the stated level).
  double rounded(double value, double unit) const;

 private:
  double one(RandomDraw& draw) const;

  InjectedNoise noise_;
  double alike_ = 0.0;  // from one reading to the next
  bool begun_ = false;
  Triple last_ = {};
};

// The readings of one row as cells.
class Instruments {
 public:
  Instruments(RandomDraw& draw, const InjectedSensors& sensors);

  std::string attitude(const Quaternion& seen, size_t row);
  std::string gyro(const Triple& rate_rad_s);

 private:
  RandomDraw& draw_;
  InjectedSensors sensors_;
  Errors camera_, gyro_;
  double side_ = 1.0;
};

}  // namespace photorque::injected
