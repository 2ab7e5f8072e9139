// A recording made ready to be compared with a model: complete attitudes, gyro readings, commands,
// averaged over blocks that are short against the motion.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "attitude/model/platform.h"
#include "attitude/recordings/columns.h"
#include "attitude/recordings/recording.h"
#include "attitude/recordings/sensors.h"

namespace photorque {

// Noise of one reading of one channel: its standard deviation, of whose square a fraction is
// correlated in time as exp(−t/τ) (an AR(1) process); the rest is white.
struct ChannelNoise {
  double level = 0.0;     // rad or rad/s
  double coloured = 0.0;  // 0 to 1
  double time_s = 0.0;    // τ
};

struct NoiseLevels {
  // One standard deviation of one reading.
  Vec3 camera_rad = Vec3(37, 37, 12) * arcsecond_rad;  // about lab x, y, z
  Vec3 gyro_rad_s = Vec3::Constant(2e-4);              // body axes
  struct Colour {
    Vec3 fraction = Vec3::Zero(), time_s = Vec3::Zero();
  } camera_colour, gyro_colour;
  std::array<ChannelNoise, scalar_count> scalar = {};  // in SI

  // The noise of a channel (recordings/columns.h).
  ChannelNoise of(int channel) const;
  void set(int channel, const ChannelNoise& noise);
};

// Factors of the noise in equal parts of a run, where a model leaves more in some than in others.
struct NoiseProfile {
  double begin_s = 0.0, part_s = 0.0;
  std::vector<double> factor;  // of each part; empty: 1

  double at(double time_s) const;
};

// Noise levels of the instruments; without stated ones the defaults above.
NoiseLevels noise_levels(const Sensors& sensors);
bool states_camera_noise(const Sensors& sensors);
bool states_gyro_noise(const Sensors& sensors);
// Whether the instruments state the noise of a channel.
bool states_noise(const Sensors& sensors, int channel);

// Readings of one scalar, block by block; empty where there are none at all.
struct ScalarReadings {
  std::vector<double> value;
  std::vector<double> rows;  // how many readings went into each; 0: none
};

// The settings of the instruments that measure a field.
struct FieldInstruments {
  Vec3 accelerometer_place_m = Vec3::Zero();  // from the centre of rotation, or of mass where free
  Vec3 accelerometer_bias_m_s2 = Vec3::Zero();
  Vec3 magnetometer_bias_T = Vec3::Zero();
};
FieldInstruments field_instruments(const Sensors& sensors);

struct Observation {
  std::string name;
  FieldInstruments fields = {};
  Schedule schedule;
  double initial_charge_C = 0.0;  // drawn before the first row
  bool has_gyro = false;
  bool is_piece = false;  // of a recording that was cut for the search alone
  // Lab axes about which the attitude is read; none: there is no attitude.
  std::array<bool, 3> sees_axis = {true, true, true};

  // Blocks of rows, by the mean of their times. A block without a reading has count 0.
  std::vector<double> time_s;
  // The times over which a block's means are taken. They contain the motion's curvature.
  struct Spread {
    double readings_s = 0.0, attitude_s = 0.0;  // root mean square about time_s
    double readings_fourth_s = 0.0;             // fourth root of the mean fourth power
    // Mean of the gyro's times relative to time_s, and the resulting correction of its mean.
    double gyro_offset_s = 0.0;
    Vec3 gyro_moved_rad_s = Vec3::Zero();
  };
  std::vector<Spread> spread;         // empty: blocks of one row each
  std::vector<Quat> attitude;         // lab from body, mean of the block
  std::vector<double> attitude_rows;  // how many rows went into it
  std::vector<Vec3> gyro_rad_s;
  std::vector<Vec3> gyro_rows;  // by axis
  std::array<ScalarReadings, scalar_count> scalar = {};
  NoiseLevels noise;
  NoiseProfile profile = {};
  double row_interval_s = 0.0;  // of the file
  int64_t rows = 0;             // of the file

  size_t blocks() const { return time_s.size(); }
  Spread spread_of(size_t block) const { return spread.empty() ? Spread() : spread[block]; }
  // Number of readings of a channel, numbered as in NoiseLevels.
  double rows_of(size_t block, int channel) const {
    if (channel >= vector_channels) {
      const auto& one = scalar[static_cast<size_t>(channel - vector_channels)];
      return one.rows.empty() ? 0.0 : one.rows[block];
    }
    if (channel >= 3) return gyro_rows[block][channel - 3];
    return sees_axis[static_cast<size_t>(channel)] ? attitude_rows[block] : 0.0;
  }
  bool sees_attitude() const { return sees_axis[0] && sees_axis[1] && sees_axis[2]; }
  bool has_some_attitude() const { return sees_axis[0] || sees_axis[1] || sees_axis[2]; }
  bool has(Scalar s) const { return !scalar[static_cast<size_t>(s)].rows.empty(); }
  bool has_scalars() const;
  // Whether anything that is read would be different at another attitude of this platform.
  bool measures_attitude(const Platform& platform) const;
  // Readings in the blocks [first, last): attitudes, or rates and scalars where there are none.
  size_t readings(size_t first, size_t last) const;
  double duration_s() const { return time_s.back() - time_s.front(); }
  // The blocks [first, last) alone, the charge drawn before them counted. Of the first, a mean over
  // times before the part began, a reading at its middle is made as far as its neighbours allow.
  Observation part(size_t first, size_t last) const;
  // Neighbours averaged until about `max_blocks` are left, but for the first row, with which a
  // motion starts: sufficient for slow motion.
  Observation averaged(size_t max_blocks) const;
};

// About `max_blocks` blocks at most; a recording with fewer rows keeps them all. InputError when
// the recording has neither an attitude nor a rate (columns.h), or fewer than 20 readings of them.
Observation observe(const Recording& recording, const std::string& name,
                    const Platform& platform = {}, size_t max_blocks = 6000);

}  // namespace photorque
