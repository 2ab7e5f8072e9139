#include "attitude/estimation/axis_readings.h"

namespace photorque {

AxisReadings angles_about(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  AxisReadings read;
  double angle_rad = 0.0;
  for (size_t i = first; i < last; ++i) {
    if (!(rows.attitude_rows[i] > 0.0)) continue;
    angle_rad +=
        read.row.empty()
            ? axis.dot(turn_vector(rows.attitude[i]))
            : axis.dot(turn_vector(rows.attitude[i] * rows.attitude[read.row.back()].conjugate()));
    read.row.push_back(i);
    read.time_s.push_back(rows.time_s[i]);
    read.value.push_back(angle_rad);
  }
  return read;
}

AxisReadings rates_about(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  Eigen::Index along = 0;
  axis.cwiseAbs().maxCoeff(&along);
  AxisReadings read;
  for (size_t i = first; i < last; ++i) {
    if (!(rows.gyro_rows[i][along] > 0.0)) continue;
    read.row.push_back(i);
    read.time_s.push_back(rows.time_s[i]);
    read.value.push_back(rows.gyro_rad_s[i][along]);
  }
  return read;
}

}  // namespace photorque
