#include "attitude/recordings/apm.h"

#include <array>
#include <cmath>
#include <string>

#include "attitude/recordings/kvn.h"
#include "core/constants.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

// The keywords of frames A and B: of version 2 and of version 1.
using FrameNames = std::array<std::array<std::string_view, 2>, 2>;
constexpr FrameNames quaternion_frames = {
    {{"REF_FRAME_A", "Q_FRAME_A"}, {"REF_FRAME_B", "Q_FRAME_B"}}};
constexpr FrameNames euler_frames = {
    {{"REF_FRAME_A", "EULER_FRAME_A"}, {"REF_FRAME_B", "EULER_FRAME_B"}}};

class ApmReader : MessageFile {
 public:
  using MessageFile::MessageFile;

  AttitudeParameters read() const {
    required(message, {"CCSDS_APM_VERS"});
    const auto [quaternion, unusable_quaternion] = block("QUAT", "Q1", quaternion_frames);
    const auto [euler, unusable_euler] = block("EULER", "EULER_ROT_SEQ", euler_frames);
    const KvnItem* source = quaternion != nullptr ? quaternion : euler;
    if (source == nullptr) {
      for (const auto& unusable : {unusable_quaternion, unusable_euler}) {
        if (unusable) throw *unusable;
      }
      throw error(message, "",
                  !blocks("SPIN", "SPIN_ALPHA").empty() ? "spin parameters alone" : "no attitude",
                  "a quaternion (QUAT_START) or Euler angles (EULER_START)");
    }
    AttitudeParameters parameters;
    parameters.epoch = read_epoch(*source);
    parameters.lab_from_body =
        quaternion != nullptr ? of_quaternion(*quaternion) : of_angles(*euler);
    parameters.rate_body_rad_s = rate(parameters.lab_from_body, quaternion, euler);
    return parameters;
  }

 private:
  // The blocks of that name. In version 1 the message itself, if it has the keyword.
  std::vector<const KvnItem*> blocks(const char* name, const char* keyword) const {
    std::vector<const KvnItem*> all;
    for (const KvnItem& item : message.items) {
      if (item.kind == KvnItem::Kind::block && item.key == name) all.push_back(&item);
    }
    if (all.empty() && message.find({keyword}) != nullptr) all.push_back(&message);
    return all;
  }

  // First of these blocks with usable frames. If none has, null and the error of the first.
  std::pair<const KvnItem*, std::optional<InputError>> block(const char* name, const char* keyword,
                                                             const FrameNames& names) const {
    std::optional<InputError> first;
    for (const KvnItem* in : blocks(name, keyword)) {
      try {
        frames(*in, names);
        return {in, std::nullopt};
      } catch (const InputError& unusable) {
        if (!first) first = unusable;
      }
    }
    return {nullptr, first};
  }

  double number(const KvnItem& item, const char* unit) const {
    if (!item.unit.empty() && item.unit != unit) {
      throw error(item, item.key, "[" + item.unit + "]", std::string("[") + unit + "]");
    }
    return require_number(item.value, {path.string(), item.line}, item.key);
  }
  double number(const KvnItem& in, const std::string& name, const char* unit) const {
    return number(required(in, {name}), unit);
  }
  Vec3 vector(const KvnItem& in, const std::array<const char*, 3>& names, const char* unit) const {
    return {number(in, names[0], unit), number(in, names[1], unit), number(in, names[2], unit)};
  }

  Epoch read_epoch(const KvnItem& source) const {
    const KvnItem* of_message = message.find({"EPOCH"});
    const KvnItem& item = of_message != nullptr ? *of_message : required(source, {"EPOCH"});
    const Epoch time = epoch(item.value, "EPOCH", item);
    const KvnItem& system = required(message, {"TIME_SYSTEM"});
    return utc(time, system.value, system);
  }

  FramePair frames(const KvnItem& in, const FrameNames& names) const {
    const KvnItem& a = required(in, {names[0][0], names[0][1]});
    return {a.value, required(in, {names[1][0], names[1][1]}).value, {path.string(), a.line}};
  }

  // The attitude from a rotation from A to B or from B to A.
  static Quat lab_from_body(const Quat& a_from_b, const FramePair& between) {
    return between.is_from_body ? a_from_b.conjugate() : a_from_b;
  }
  bool is_backwards(const KvnItem& in, std::string_view name) const {
    const KvnItem* direction = in.find({name});
    if (direction == nullptr || direction->value == "A2B") return false;
    if (direction->value == "B2A") return true;
    throw error(*direction, direction->key, in_quotes(direction->value), "A2B or B2A");
  }

  Quat of_quaternion(const KvnItem& in) const {
    const FramePair between = frames(in, quaternion_frames);
    const Quat q = unit(
        {number(in, "QC", ""), number(in, "Q1", ""), number(in, "Q2", ""), number(in, "Q3", "")},
        required(in, {"Q1"}), "Q1 … QC");
    return lab_from_body(is_backwards(in, "Q_DIR") ? q.conjugate() : q, between);
  }

  // Axes and angles of successive_rotations().
  struct Euler {
    std::array<int, 3> axes;
    Vec3 angles_rad;
  };
  Euler read_angles(const KvnItem& in) const {
    const KvnItem& sequence = required(in, {"EULER_ROT_SEQ"});
    const bool is_version_1 = in.find({"ANGLE_1"}) == nullptr;
    const auto places = axes_of_sequence(sequence.value);
    if (!places || (*places)[0] == (*places)[1] || (*places)[1] == (*places)[2]) {
      throw error(sequence, "EULER_ROT_SEQ", in_quotes(sequence.value),
                  "three axes, as 321 or ZYX");
    }
    Euler euler{*places, {}};
    constexpr std::array<const char*, 3> of_version_2 = {"ANGLE_1", "ANGLE_2", "ANGLE_3"};
    constexpr std::array<const char*, 3> of_version_1 = {"X_ANGLE", "Y_ANGLE", "Z_ANGLE"};
    for (size_t i = 0; i < 3; ++i) {
      const KvnItem* angle = nullptr;
      if (!is_version_1) {
        angle = &required(in, {of_version_2[i]});
      } else {
        // If an axis occurs twice, its second angle is further down.
        const char* name = of_version_1[static_cast<size_t>((*places)[i])];
        int skip = i == 2 && (*places)[2] == (*places)[0] ? 1 : 0;
        for (const KvnItem& item : in.items) {
          if (item.key == name && skip-- == 0) angle = &item;
        }
        if (angle == nullptr) throw error(in, name, "nothing", "an angle of EULER_ROT_SEQ");
      }
      euler.angles_rad[static_cast<Eigen::Index>(i)] = degree_rad * number(*angle, "deg");
    }
    return euler;
  }

  Quat of_angles(const KvnItem& in) const {
    const FramePair between = frames(in, euler_frames);
    const Euler euler = read_angles(in);
    const Quat q = successive_rotations(euler.axes, euler.angles_rad);
    return lab_from_body(is_backwards(in, "EULER_DIR") ? q.conjugate() : q, between);
  }

  std::optional<Vec3> rate(const Quat& lab_from_body_now, const KvnItem* quaternion,
                           const KvnItem* euler) const {
    const auto [angular, unusable] = block("ANGVEL", "ANGVEL_X", quaternion_frames);
    if (unusable) throw *unusable;
    if (angular != nullptr) {
      const FramePair between = frames(*angular, quaternion_frames);
      const KvnItem& axes = required(*angular, {"ANGVEL_FRAME"});
      Vec3 rate_rad_s =
          degree_rad * vector(*angular, {"ANGVEL_X", "ANGVEL_Y", "ANGVEL_Z"}, "deg/s");
      const bool are_of_a =
          are_axes_of_a(axes.value, between.a, between.b, {path.string(), axes.line});
      if (are_of_a != between.is_from_body) {
        rate_rad_s = lab_from_body_now.conjugate() * rate_rad_s;
      }
      // The rate of B with respect to A.
      return between.is_from_body ? Vec3(-rate_rad_s) : rate_rad_s;
    }
    if (quaternion != nullptr && quaternion->find({"Q1_DOT"}) != nullptr) {
      const Vec3 dot = vector(*quaternion, {"Q1_DOT", "Q2_DOT", "Q3_DOT"}, "1/s");
      Quat slope(number(*quaternion, "QC_DOT", "1/s"), dot.x(), dot.y(), dot.z());
      const bool is_inverse =
          frames(*quaternion, quaternion_frames).is_from_body != is_backwards(*quaternion, "Q_DIR");
      if (is_inverse) slope = slope.conjugate();
      return 2.0 * (lab_from_body_now.conjugate() * slope).vec();
    }
    return euler != nullptr ? rate_of_angles(*euler) : std::nullopt;
  }

  std::optional<Vec3> rate_of_angles(const KvnItem& in) const {
    if (const KvnItem* old = in.find({"X_RATE", "Y_RATE", "Z_RATE"})) {
      throw error(*old, old->key, "rates of Euler angles in version 1, whose frame is not stated",
                  "an APM of version 2, or no rates and propagate.initial_rate_rad_s");
    }
    if (in.find({"ANGLE_1_DOT"}) == nullptr) return std::nullopt;
    const Euler euler = read_angles(in);
    const Vec3 slopes_rad_s =
        degree_rad * vector(in, {"ANGLE_1_DOT", "ANGLE_2_DOT", "ANGLE_3_DOT"}, "deg/s");
    Vec3 of_b_rad_s = Vec3::Zero();  // with respect to A, in B's axes
    for (int i = 0; i < 3; ++i) {
      const Quat after = successive_rotations(euler.axes, euler.angles_rad, i + 1);
      of_b_rad_s +=
          slopes_rad_s[i] * (after.conjugate() * Vec3::Unit(euler.axes[static_cast<size_t>(i)]));
    }
    if (!frames(in, euler_frames).is_from_body) return of_b_rad_s;
    return -(successive_rotations(euler.axes, euler.angles_rad) * of_b_rad_s);
  }
};

}  // namespace

AttitudeParameters read_apm(const std::filesystem::path& path) {
  return ApmReader(path, "APM").read();
}

}  // namespace photorque
