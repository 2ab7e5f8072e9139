// A recording prepared for comparison with a model: complete attitudes, gyro readings and commands,
// averaged over blocks that are short compared with the motion.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "attitude/model/platform.h"
#include "attitude/recordings/columns.h"
#include "attitude/recordings/recording.h"
#include "attitude/recordings/sensors.h"

namespace photorque {

// Noise of one reading of one channel. A fraction `coloured` of its variance is correlated in time
// as exp(−t/τ) (an AR(1) process); the rest is white.
struct ChannelNoise {
  double level = 0.0;     // standard deviation, rad or rad/s
  double coloured = 0.0;  // fraction, 0 to 1
  double time_s = 0.0;    // τ
};

struct NoiseLevels {
  // Noise of one reading, by channel (recordings/columns.h), SI.
  std::array<ChannelNoise, channel_count> channel = {};

  NoiseLevels() {
    set_levels(0, Vec3(37, 37, 12) * arcsecond_rad);  // of the camera about lab x, y, z
    set_levels(3, Vec3::Constant(2e-4));              // of the gyro, body axes
  }
  const ChannelNoise& of(int which) const { return channel[static_cast<size_t>(which)]; }
  void set(int which, const ChannelNoise& noise) { channel[static_cast<size_t>(which)] = noise; }
  // The standard deviations of three channels from `first` on.
  Vec3 levels(int first) const {
    return {of(first).level, of(first + 1).level, of(first + 2).level};
  }
  void set_levels(int first, const Vec3& level) {
    for (int k = 0; k < 3; ++k) channel[static_cast<size_t>(first + k)].level = level[k];
  }
};

// Factors of the noise in equal parts of a run, for a model that fits some parts worse than others.
struct NoiseProfile {
  double begin_s = 0.0, part_s = 0.0;
  std::vector<double> factor;  // of each part; empty: 1

  // Factor at a time.
  double at(double time_s) const;
};

// Noise levels of the instruments; without stated ones, the defaults above.
NoiseLevels noise_levels(const Sensors& sensors);
// Whether the instruments state the noise of a channel.
bool states_noise(const Sensors& sensors, int channel);

// Readings of one scalar, block by block; empty if there are none.
struct ScalarReadings {
  std::vector<double> value;
  std::vector<double> rows;  // number of readings in each mean; 0: none
};

// Settings of accelerometer and magnetometer.
struct FieldInstruments {
  Vec3 accelerometer_place_m = Vec3::Zero();  // from the centre of rotation; if free, of mass
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
  bool is_piece = false;  // a segment of a recording that was cut for the search
  // The axis of a platform with one axis, and the angle about it at the first attitude. Whole turns
  // are counted so that the middle angle of the recording is within half a turn of zero.
  Vec3 only_axis = Vec3::Zero();
  std::optional<double> first_angle_rad = {};
  // Lab axes about which the attitude was measured; none: there is no attitude.
  std::array<bool, 3> sees_axis = {true, true, true};

  // Blocks of rows, at the mean of their times. A block without a reading has count 0.
  std::vector<double> time_s;
  // Spread of the times of a block's readings, on which the effect of the curvature depends.
  struct Spread {
    double readings_s = 0.0, attitude_s = 0.0;  // root mean square about time_s
    double readings_fourth_s = 0.0;             // fourth root of the mean fourth power
    // Mean of the gyro's times relative to time_s, and the resulting correction of its mean.
    double gyro_offset_s = 0.0;
    Vec3 gyro_moved_rad_s = Vec3::Zero();
  };
  std::vector<Spread> spread;         // empty: blocks of one row each
  std::vector<Quat> attitude;         // lab from body, mean of the block
  std::vector<double> attitude_rows;  // number of rows in the mean
  std::vector<Vec3> gyro_rad_s;
  std::vector<Vec3> gyro_rows;  // number of rows in each axis
  std::array<ScalarReadings, scalar_count> scalar = {};
  NoiseLevels noise;
  NoiseProfile profile = {};
  double row_interval_s = 0.0;  // of the rows of the file
  int64_t rows = 0;             // number of rows of the file

  size_t blocks() const { return time_s.size(); }
  Spread spread_of(size_t block) const { return spread.empty() ? Spread() : spread[block]; }
  // Number of readings of a channel in a block. Channels are numbered as in NoiseLevels.
  double rows_of(size_t block, int channel) const {
    if (channel >= vector_channels) {
      const auto& one = scalar[static_cast<size_t>(channel - vector_channels)];
      return one.rows.empty() ? 0.0 : one.rows[block];
    }
    if (channel >= 3) return gyro_rows[block][channel - 3];
    return sees_axis[static_cast<size_t>(channel)] ? attitude_rows[block] : 0.0;
  }
  // That number to be changed; the components of an attitude share it.
  double& rows_in(size_t block, int channel) {
    if (channel < 3) return attitude_rows[block];
    return channel < vector_channels
               ? gyro_rows[block][channel - 3]
               : scalar[static_cast<size_t>(channel - vector_channels)].rows[block];
  }
  // The mean of the readings of a rate or scalar (channel 3 or above) in a block.
  const double& value_of(size_t block, int channel) const {
    return channel < vector_channels
               ? gyro_rad_s[block][channel - 3]
               : scalar[static_cast<size_t>(channel - vector_channels)].value[block];
  }
  double& value_of(size_t block, int channel) {
    return const_cast<double&>(std::as_const(*this).value_of(block, channel));
  }
  bool sees_attitude() const { return sees_axis[0] && sees_axis[1] && sees_axis[2]; }
  bool has_some_attitude() const { return sees_axis[0] || sees_axis[1] || sees_axis[2]; }
  bool has(Scalar s) const { return !scalar[static_cast<size_t>(s)].rows.empty(); }
  bool has_channel(int channel) const {
    return channel < vector_channels || has(static_cast<Scalar>(channel - vector_channels));
  }
  bool has_scalars() const;
  // Whether some measured quantity depends on the attitude of this platform.
  bool measures_attitude(const Platform& platform) const;
  // Number of blocks with a reading in [first, last): of an attitude or, if there is none, of a
  // rate or scalar.
  size_t readings(size_t first, size_t last) const;
  // Angles about an axis with whole turns counted, of the blocks [first, last); NaN: it has no
  // attitude. The first angle is within half a turn of zero; from the first block on it has the
  // whole turns of `first_angle_rad`.
  std::vector<double> angles_rad(const Vec3& axis, size_t first, size_t last) const;
  double duration_s() const { return time_s.back() - time_s.front(); }
  // The blocks [first, last), with the charge drawn before them. If the first block is a mean, it
  // is converted to a reading at its centre, as far as its neighbours permit.
  Observation part(size_t first, size_t last) const;
  // Neighbouring rows averaged to about `max_blocks` blocks. The first row, at which a motion
  // starts, is not averaged. For motion that is slow compared with a block.
  Observation averaged(size_t max_blocks) const;
};

// Prepares a recording: at most about `max_blocks` blocks; a recording with fewer rows is not
// averaged. InputError if the recording has neither an attitude nor a rate (columns.h), or fewer
// than 20 readings of them.
Observation observe(const Recording& recording, const std::string& name,
                    const Platform& platform = {}, size_t max_blocks = 6000);

}  // namespace photorque
