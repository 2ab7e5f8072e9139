// Light in a simulation of the attitude: the table [light], and torque and power at any attitude.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "attitude/disturbances/fields/light_pressure.h"
#include "attitude/model/platform.h"
#include "core/numerics/table.h"
#include "photovoltaics/array/supply.h"
#include "scenes/experiment/experiment.h"
#include "tools/runs/array_power.h"

namespace photorque {

// The table [light].

// [light]
struct LightSettings {
  enum class Mode {
    table,  // traced in advance over the attitudes, then interpolated
    trace,  // traced at every exchange of the run
    off,    // no light, as if there were no scene
  };
  Mode mode = Mode::table;
  double tolerance = 1e-3;  // of the table, relative to the largest value
  double step_s = 1.0;      // between exchanges of motion and power
  uint64_t rays = 0;        // per attitude
  size_t max_traces = 20000;
  std::optional<double> max_tilt_rad;  // range of the first table
  std::optional<std::filesystem::path>
      cache;  // folder of stored tables; empty: tables are not stored
  // [[light.switch]]: switches the lamps of one source, or all.
  struct Switch {
    double time_s = 0.0;
    std::string source;  // empty: all
    bool on = true;
  };
  std::vector<Switch> switches;  // sorted by time
};

// Whether `propagate` couples light and motion: the file has a scene, sources and a platform.
bool has_light(const ExperimentFile& file);

// Reads [light], which may be absent. Throws InputError for invalid keys and for switches that are
// not sorted by time.
LightSettings read_light(const ExperimentFile& file);
Key light_table();

// The experiment's light as a function of attitude, traced or from a table. Channels of a group of
// lamps, from `first`: torque about the body origin and force (x, y, z, body axes); then, if there
// is an array, the photocurrent of each cell at the array's temperature and all light on the cells
// [W].
class LightModel {
 public:
  // Reads scene, sources and array. Sources named in [[light.switch]] form separate groups.
  LightModel(const RunOptions& options, const Console& console, const LightSettings& settings,
             const Platform& platform);
  ~LightModel();

  struct Group {
    std::string name;  // that of the source; "light" if there is one group
    size_t first = 0;  // channel
    bool is_sun = false;
    double emitted_W = 0.0;  // 0 for the Sun
    size_t position = 0;  // index of the joint's position for a joint with a schedule, see weight()
  };
  const std::vector<Group>& groups() const { return groups_; }
  // Weight of a group at an instant: that of its joint position, otherwise 1.
  double weight(const Group& group, double time_s) const;
  // Times in the schedule of the joint, at which the angular rate changes.
  std::vector<double> corners_s() const;
  size_t cells() const { return cell_area_m2_.size(); }
  size_t channels_per_group() const { return cells() > 0 ? 7 + cells() : 6; }

  const std::optional<ArrayDesign>& array() const { return array_; }
  const std::optional<DaySettings>& day() const { return day_; }
  const std::optional<Tracker>& tracker() const { return tracker_; }
  const std::vector<double>& cell_area_m2() const { return cell_area_m2_; }
  // Direction towards the Sun in the lab, if it is the only light.
  const std::optional<Vec3>& sun_direction_lab() const { return sun_direction_lab_; }
  const std::vector<std::pair<std::string, std::string>>& inputs() const { return inputs_; }

  // All channels at one attitude.
  RotationSample trace(const Quat& lab_from_body) const;

  // Largest possible angle of body z from the vertical, or from the Sun if it is the only light:
  // the tilt limit of the platform, or π.
  double max_angle_rad() const { return max_angle_rad_; }
  // Range of the first table for a motion with this initial tilt. A run in real time cannot restart
  // with a wider table: its range is [light] max_tilt_deg or all angles.
  double first_angle_rad(double initial_tilt_rad, bool is_live) const;
  // Table up to an angle, from the cache or traced; prints its origin.
  std::shared_ptr<const RotationTable> make_table(const Console& console,
                                                  double max_angle_rad) const;

  // Names and units of the groups of channels, in the order of RotationTableError.
  static constexpr const char* quantities[] = {"torque", "force", "photocurrent", "light on cells"};
  static constexpr const char* units[] = {"N m", "N", "A", "W"};

 private:
  // One pose of the scene with one group of lamps.
  struct Light {
    std::unique_ptr<OpticalRun> run;
    std::optional<ArrayPower> array;
  };
  Light make_light(std::unique_ptr<OpticalRun> run, const std::string& group,
                   std::optional<double> joint_rad) const;
  void find_joint(const ExperimentFile& file);
  std::string group_of(const Beam& beam) const;
  void add(const Light& light, const Quat& lab_from_body, RotationSample& sample) const;
  std::string content_key(const ExperimentFile& file) const;

  LightSettings settings_;
  int threads_ = 0;
  std::vector<Group> groups_;
  std::vector<Light>
      lights_;  // one per group; with the joint at its rest angle if it follows the Sun
  std::optional<Joint> joint_;  // the moving joint
  size_t joint_number_ = 0;     // index among [[joint]]
  std::optional<JointPositions> positions_;
  RunOptions options_;
  std::optional<ArrayDesign> array_;
  std::optional<DaySettings> day_;
  std::optional<Tracker> tracker_;
  std::vector<double> cell_area_m2_;
  std::optional<Vec3> sun_direction_lab_;
  std::vector<std::pair<std::string, std::string>> inputs_;
  double sun_angle_rad_ = 0.0;  // from the vertical; 0 if the Sun is not the only light
  double max_angle_rad_ = 0.0;
  std::string key_;
};

}  // namespace photorque
