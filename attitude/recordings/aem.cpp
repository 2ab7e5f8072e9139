#include "attitude/recordings/aem.h"

#include <algorithm>
#include <array>

#include "attitude/recordings/kvn.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"

namespace photorque {

namespace {

// Keywords of the metadata of a segment, in the order of the book.
struct Keyword {
  const char* name;
  bool required = false;
};
constexpr auto keywords = std::to_array<Keyword>({{"OBJECT_NAME", true},
                                                  {"OBJECT_ID"},
                                                  {"CENTER_NAME"},
                                                  {"REF_FRAME_A", true},
                                                  {"REF_FRAME_B", true},
                                                  {"ATTITUDE_DIR"},
                                                  {"TIME_SYSTEM", true},
                                                  {"START_TIME", true},
                                                  {"USEABLE_START_TIME"},
                                                  {"USEABLE_STOP_TIME"},
                                                  {"STOP_TIME", true},
                                                  {"ATTITUDE_TYPE", true},
                                                  {"QUATERNION_TYPE"},
                                                  {"EULER_ROT_SEQ"},
                                                  {"RATE_FRAME"},
                                                  {"ANGVEL_FRAME"},
                                                  {"INTERPOLATION_METHOD"},
                                                  {"INTERPOLATION_DEGREE"}});

// The numbers of a row.
struct AttitudeType {
  const char* name;
  size_t numbers;     // after the epoch
  bool is_euler;      // three angles [deg], else four numbers of a quaternion
  bool ends_in_rate;  // angular velocity [deg/s] in ANGVEL_FRAME
};
constexpr std::array attitude_types = {AttitudeType{"QUATERNION", 4, false, false},
                                       AttitudeType{"QUATERNION/DERIVATIVE", 8, false, false},
                                       AttitudeType{"QUATERNION/RATE", 7, false, false},
                                       AttitudeType{"QUATERNION/ANGVEL", 7, false, true},
                                       AttitudeType{"EULER_ANGLE", 3, true, false},
                                       AttitudeType{"EULER_ANGLE/DERIVATIVE", 6, true, false},
                                       AttitudeType{"EULER_ANGLE/RATE", 6, true, false},
                                       AttitudeType{"EULER_ANGLE/ANGVEL", 6, true, true}};

class AemReader : MessageFile {
 public:
  using MessageFile::MessageFile;

  AttitudeEphemeris read() {
    for (const char* name : {"CCSDS_AEM_VERS", "CREATION_DATE", "ORIGINATOR"}) {
      required(message, {name});
    }
    const KvnItem* meta = nullptr;
    for (const KvnItem& item : message.items) {
      if (item.kind != KvnItem::Kind::block) continue;
      if (item.key == "META") {
        meta = &item;
      } else if (item.key == "DATA" && meta != nullptr) {
        add_segment(*meta, item);
        meta = nullptr;
      } else {
        throw error(item, "", item.key + "_START", "META_START and DATA_START in turn");
      }
    }
    if (!object_) throw error(message, "", "no segment", "META and DATA blocks");
    return std::move(aem_);
  }

 private:
  static std::string text(const KvnItem& meta, std::string_view name, const char* otherwise = "") {
    const KvnItem* item = meta.find({name});
    return item != nullptr ? item->value : otherwise;
  }

  void check_keywords(const KvnItem& meta) const {
    for (const Keyword& keyword : keywords) {
      if (keyword.required) required(meta, {keyword.name});
    }
    for (const KvnItem& item : meta.items) {
      const bool is_known = std::ranges::find(keywords, item.key, &Keyword::name) != keywords.end();
      if (item.kind == KvnItem::Kind::assignment && !is_known) {
        throw error(item, "", item.key, "a keyword of AEM metadata");
      }
    }
    if (text(message, "CCSDS_AEM_VERS").starts_with("1")) required(meta, {"ATTITUDE_DIR"});
    const std::string direction = text(meta, "ATTITUDE_DIR", "A2B"),
                      scalar = text(meta, "QUATERNION_TYPE", "LAST");
    if (direction != "A2B" && direction != "B2A") {
      throw error(meta, "", direction, "ATTITUDE_DIR = A2B or B2A");
    }
    if (scalar != "FIRST" && scalar != "LAST") {
      throw error(required(meta, {"QUATERNION_TYPE"}), "QUATERNION_TYPE", in_quotes(scalar),
                  "FIRST or LAST");
    }
  }

  void add_segment(const KvnItem& meta, const KvnItem& data) {
    check_keywords(meta);
    const std::string object = text(meta, "OBJECT_NAME"), named = text(meta, "ATTITUDE_TYPE"),
                      a = text(meta, "REF_FRAME_A"), b = text(meta, "REF_FRAME_B");
    if (!object_) object_ = object;
    if (kvn_word(object) != kvn_word(*object_)) {
      throw error(meta, "OBJECT_NAME", in_quotes(object) + " after " + in_quotes(*object_),
                  "segments of one object");
    }
    const InputLocation where{path.string(), meta.line};
    const FramePair frames(a, b, where);
    if (aem_.lab_frame.empty()) aem_.lab_frame = frames.lab();
    const auto* const type = std::ranges::find(attitude_types, named, &AttitudeType::name);
    if (type == attitude_types.end()) {
      throw InputError({path.string()}, "ATTITUDE_TYPE", named,
                       "QUATERNION or EULER_ANGLE, or one of them with /DERIVATIVE, /RATE or "
                       "/ANGVEL");
    }
    const bool is_rate_in_a =
        type->ends_in_rate && are_axes_of_a(text(meta, "ANGVEL_FRAME"), a, b, where);
    for (const KvnItem& item : data.items) {
      const auto [time, v] = row(item);
      if (v.size() != type->numbers) {
        throw error(item, "", std::to_string(v.size()) + " numbers",
                    std::to_string(type->numbers) + " after the epoch");
      }
      const Epoch now = epoch(time, "epoch", item);
      if (!begin_) begin_ = now;
      Quat a_from_b = type->is_euler ? of_angles(meta, v, item) : of_quaternion(meta, v, item);
      if (text(meta, "ATTITUDE_DIR") == "B2A") a_from_b = a_from_b.conjugate();
      AemAttitude attitude{now.seconds_since(*begin_), a_from_b, {}, item.line};
      if (type->ends_in_rate) {
        // The rate of B with respect to A, in axes of B.
        const Vec3 rate_rad_s = degree_rad * Vec3(v.data() + v.size() - 3);
        attitude.rate_body_rad_s =
            is_rate_in_a ? Vec3(a_from_b.conjugate() * rate_rad_s) : rate_rad_s;
      }
      if (frames.is_from_body) {
        attitude.lab_from_body = a_from_b.conjugate();
        // A is the body. Its rate is minus that of the lab B, converted from the axes of B to those
        // of A.
        if (type->ends_in_rate) attitude.rate_body_rad_s = -(a_from_b * *attitude.rate_body_rad_s);
      }
      aem_.rows.push_back(attitude);
    }
  }

  Quat of_angles(const KvnItem& meta, const std::vector<double>& angles_deg,
                 const KvnItem& item) const {
    const std::string sequence = text(meta, "EULER_ROT_SEQ");
    const auto axes = axes_of_sequence(sequence);
    if (!axes) throw error(item, "EULER_ROT_SEQ", sequence, "three axes, as 321");
    return successive_rotations(*axes, degree_rad * Vec3(angles_deg.data()));
  }

  Quat of_quaternion(const KvnItem& meta, const std::vector<double>& v, const KvnItem& item) const {
    const bool first = text(meta, "QUATERNION_TYPE") == "FIRST";
    return unit(first ? Quat(v[0], v[1], v[2], v[3]) : Quat(v[3], v[0], v[1], v[2]), item, "");
  }

  AttitudeEphemeris aem_;
  std::optional<std::string> object_;  // of the first segment
  std::optional<Epoch> begin_;         // of the first row
};

}  // namespace

AttitudeEphemeris read_aem(const std::filesystem::path& path) {
  return AemReader(path, "AEM").read();
}

bool is_aem(const std::filesystem::path& path) {
  const std::vector<std::string> kinds = kinds_of_messages(path);
  if (kinds.empty() || std::ranges::find(kinds, "AEM") != kinds.end()) return !kinds.empty();
  throw InputError({path.string()}, "", "a CCSDS message " + joined_text(kinds, ", "),
                   "a recording: of CCSDS messages an attitude ephemeris (AEM)");
}

bool is_in_space(const std::filesystem::path& path) {
  return is_aem(path) && !read_aem(path).lab_frame.starts_with("LAB");
}

void write_aem(const std::filesystem::path& path, const std::vector<PlatformState>& states,
               const std::string& epoch, const std::string& object_name,
               const std::string& comment) {
  const std::optional<Epoch> zero = parse_epoch(epoch);
  if (!zero) throw InputError({}, "epoch", epoch, "a time as 2000-01-01T12:00:00");
  const auto time = [&](const PlatformState& state) {
    return epoch_text(zero->after(state.time_s));
  };
  std::string text = "CCSDS_AEM_VERS = 1.0\nCOMMENT " + comment + "\nCREATION_DATE  = " + epoch +
                     "\nORIGINATOR     = PHOTORQUE\n\nMETA_START\n"
                     "COMMENT LAB: x east, y north, z up; the quaternion rotates body vectors into "
                     "it\nOBJECT_NAME     = " +
                     object_name +
                     "\nOBJECT_ID       = NONE\nCENTER_NAME     = EARTH\n"
                     "REF_FRAME_A     = LAB\nREF_FRAME_B     = SC_BODY_1\n"
                     "ATTITUDE_DIR    = A2B\nTIME_SYSTEM     = UTC\nSTART_TIME      = " +
                     time(states.front()) + "\nSTOP_TIME       = " + time(states.back()) +
                     "\nATTITUDE_TYPE   = QUATERNION\nQUATERNION_TYPE = LAST\nMETA_STOP\n\n"
                     "DATA_START\n";
  for (const PlatformState& state : states) {
    const Quat& q = state.lab_from_body;
    text += time(state);
    for (const double component : {q.x(), q.y(), q.z(), q.w()}) text += " " + shortest(component);
    text += "\n";
  }
  write_file_whole(path, text + "DATA_STOP\n");
}

}  // namespace photorque
