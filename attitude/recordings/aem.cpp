#include "attitude/recordings/aem.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "attitude/environment/epoch.h"
#include "attitude/recordings/frames.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"

namespace photorque {

namespace {

using Segment = AttitudeEphemeris::Segment;

// Keywords of the metadata of a segment, in the order of the book.
struct Keyword {
  const char* name;
  std::string Segment::*member;
  bool required;
};
constexpr std::array<Keyword, 18> keywords = {{
    {"OBJECT_NAME", &Segment::object_name, true},
    {"OBJECT_ID", &Segment::object_id, false},
    {"CENTER_NAME", &Segment::center_name, false},
    {"REF_FRAME_A", &Segment::ref_frame_a, true},
    {"REF_FRAME_B", &Segment::ref_frame_b, true},
    {"ATTITUDE_DIR", &Segment::attitude_dir, false},
    {"TIME_SYSTEM", &Segment::time_system, true},
    {"START_TIME", &Segment::start_time, true},
    {"USEABLE_START_TIME", &Segment::useable_start_time, false},
    {"USEABLE_STOP_TIME", &Segment::useable_stop_time, false},
    {"STOP_TIME", &Segment::stop_time, true},
    {"ATTITUDE_TYPE", &Segment::attitude_type, true},
    {"QUATERNION_TYPE", &Segment::quaternion_type, false},
    {"EULER_ROT_SEQ", &Segment::euler_rot_seq, false},
    {"RATE_FRAME", &Segment::rate_frame, false},
    {"ANGVEL_FRAME", &Segment::angvel_frame, false},
    {"INTERPOLATION_METHOD", &Segment::interpolation_method, false},
    {"INTERPOLATION_DEGREE", &Segment::interpolation_degree, false},
}};

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

const AttitudeType* type_of(const Segment& segment) {
  const auto* const found =
      std::ranges::find(attitude_types, segment.attitude_type, &AttitudeType::name);
  return found != attitude_types.end() ? found : nullptr;
}

class AemReader : MessageFile {
 public:
  using MessageFile::MessageFile;

  AttitudeEphemeris read() const {
    AttitudeEphemeris aem;
    aem.version = required(message, {"CCSDS_AEM_VERS"}).value;
    aem.creation_date = required(message, {"CREATION_DATE"}).value;
    aem.originator = required(message, {"ORIGINATOR"}).value;
    const KvnItem* meta = nullptr;
    for (const KvnItem& item : message.items) {
      if (item.kind == KvnItem::Kind::comment) aem.comments.push_back(item.value);
      if (item.kind != KvnItem::Kind::block) continue;
      if (item.key == "META") {
        meta = &item;
      } else if (item.key == "DATA" && meta != nullptr) {
        aem.segments.push_back(read_segment(*meta, item));
        meta = nullptr;
      } else {
        throw error(item, "", item.key + "_START", "META_START and DATA_START in turn");
      }
    }
    if (aem.segments.empty()) throw error(message, "", "no segment", "META and DATA blocks");
    return aem;
  }

 private:
  Segment read_segment(const KvnItem& meta, const KvnItem& data) const {
    Segment segment;
    segment.line = meta.line;
    for (const Keyword& keyword : keywords) {
      const KvnItem* item =
          keyword.required ? &required(meta, {keyword.name}) : meta.find({keyword.name});
      if (item != nullptr) segment.*keyword.member = item->value;
    }
    for (const KvnItem& item : meta.items) {
      if (item.kind == KvnItem::Kind::comment) segment.comments.push_back(item.value);
      const bool is_known = std::ranges::find(keywords, item.key, &Keyword::name) != keywords.end();
      if (item.kind == KvnItem::Kind::assignment && !is_known) {
        throw error(item, "", item.key, "a keyword of AEM metadata");
      }
    }
    if (message.find({"CCSDS_AEM_VERS"})->value.starts_with("1")) required(meta, {"ATTITUDE_DIR"});
    if (segment.attitude_dir != "A2B" && segment.attitude_dir != "B2A") {
      throw error(meta, "", segment.attitude_dir, "ATTITUDE_DIR = A2B or B2A");
    }
    const KvnItem* scalar = meta.find({"QUATERNION_TYPE"});
    if (scalar != nullptr && scalar->value != "FIRST" && scalar->value != "LAST") {
      throw error(*scalar, scalar->key, in_quotes(scalar->value), "FIRST or LAST");
    }
    const AttitudeType* type = type_of(segment);
    for (const KvnItem& item : data.items) {
      if (item.kind == KvnItem::Kind::comment) continue;
      Row of = row(item);
      segment.rows.push_back({std::move(of.epoch), std::move(of.numbers), item.line});
      // For types that are not read as attitudes, all rows must have the length of the first.
      const size_t now = segment.rows.back().values.size(),
                   length = type != nullptr ? type->numbers : segment.rows.front().values.size();
      if (now != length) {
        throw error(item, "", std::to_string(now) + " numbers",
                    std::to_string(length) + " after the epoch");
      }
    }
    return segment;
  }
};

// Successive rotations about the axes of `sequence` ("321" or "ZYX"), each about an axis of the
// frame that the previous rotations rotated.
Quat from_euler(const std::string& sequence, const std::vector<double>& angles_deg,
                const InputLocation& where) {
  const auto axes = axes_of_sequence(sequence);
  if (!axes) throw InputError(where, "EULER_ROT_SEQ", sequence, "three axes, as 321");
  Quat q = Quat::Identity();
  for (size_t i = 0; i < axes->size(); ++i) {
    q = q * Quat(Eigen::AngleAxisd(angles_deg[i] * degree_rad, Vec3::Unit((*axes)[i])));
  }
  return q;
}

Quat to_quaternion(const Segment& segment, const AttitudeType& type, const std::vector<double>& v,
                   const InputLocation& where) {
  if (type.is_euler) return from_euler(segment.euler_rot_seq, v, where);
  const bool first = segment.quaternion_type == "FIRST";
  const Quat q = first ? Quat(v[0], v[1], v[2], v[3]) : Quat(v[3], v[0], v[1], v[2]);
  if (!(std::abs(q.norm() - 1.0) < 0.01)) {
    throw InputError(where, "", "a quaternion of norm " + shortest(q.norm()), "unit norm");
  }
  return q.normalized();
}

Epoch epoch_of(const std::string& text, const InputLocation& where) {
  const std::optional<Epoch> epoch = parse_epoch(text);
  if (!epoch) throw InputError(where, "epoch", text, "a time as 2000-01-01T12:00:00");
  return *epoch;
}

FramePair frames_of(const Segment& segment, const std::filesystem::path& file) {
  return {segment.ref_frame_a, segment.ref_frame_b, {file.string(), segment.line}};
}

}  // namespace

std::vector<Segment::Sample> Segment::attitudes(const std::filesystem::path& file) const {
  const AttitudeType* type = type_of(*this);
  if (type == nullptr) {
    throw InputError({file.string()}, "ATTITUDE_TYPE", attitude_type,
                     "QUATERNION or EULER_ANGLE, or one of them with /DERIVATIVE, /RATE or "
                     "/ANGVEL");
  }
  const bool is_rate_in_a = type->ends_in_rate && are_axes_of_a(angvel_frame, ref_frame_a,
                                                                ref_frame_b, {file.string(), line});
  std::vector<Sample> samples;
  std::optional<Epoch> first;
  for (const Row& row : rows) {
    const InputLocation where{file.string(), row.line};
    const Epoch epoch = epoch_of(row.epoch, where);
    if (!first) first = epoch;
    Quat q = to_quaternion(*this, *type, row.values, where);
    if (attitude_dir == "B2A") q = q.conjugate();
    samples.push_back({epoch.seconds_since(*first), q});
    if (!type->ends_in_rate) continue;
    const double* rate = row.values.data() + row.values.size() - 3;
    const Vec3 rate_rad_s = degree_rad * Vec3(rate[0], rate[1], rate[2]);
    samples.back().rate_rad_s = is_rate_in_a ? Vec3(q.conjugate() * rate_rad_s) : rate_rad_s;
  }
  return samples;
}

std::vector<AemAttitude> aem_attitudes(const std::filesystem::path& path) {
  const AttitudeEphemeris aem = read_aem(path);
  const Segment& first = aem.segments.front();
  std::vector<AemAttitude> all;
  std::optional<Epoch> begin;
  for (const Segment& segment : aem.segments) {
    if (kvn_word(segment.object_name) != kvn_word(first.object_name)) {
      throw InputError({path.string(), segment.line}, "OBJECT_NAME",
                       in_quotes(segment.object_name) + " after " + in_quotes(first.object_name),
                       "segments of one object");
    }
    const bool is_from_body = frames_of(segment, path).is_from_body;
    const std::vector<Segment::Sample> samples = segment.attitudes(path);
    for (size_t i = 0; i < samples.size(); ++i) {
      const Epoch epoch = *parse_epoch(segment.rows[i].epoch);
      if (!begin) begin = epoch;
      const Quat& q = samples[i].a_from_b;
      AemAttitude attitude{epoch.seconds_since(*begin), is_from_body ? Quat(q.conjugate()) : q,
                           samples[i].rate_rad_s, segment.rows[i].line};
      // A is the body. Its rate is minus that of the lab B, converted from the axes of B to those
      // of A.
      if (is_from_body && attitude.rate_body_rad_s) {
        attitude.rate_body_rad_s = -(q * *attitude.rate_body_rad_s);
      }
      all.push_back(attitude);
    }
  }
  return all;
}

bool is_aem(const std::filesystem::path& path) {
  const std::vector<std::string> kinds = kinds_of_messages(path);
  if (kinds.empty() || std::ranges::find(kinds, "AEM") != kinds.end()) return !kinds.empty();
  throw InputError({path.string()}, "", "a CCSDS message " + joined_text(kinds, ", "),
                   "a recording: of CCSDS messages an attitude ephemeris (AEM)");
}

bool is_in_space(const std::filesystem::path& path) {
  return is_aem(path) && !frames_of(read_aem(path).segments.front(), path).lab().starts_with("LAB");
}

AttitudeEphemeris read_aem(const std::filesystem::path& path) {
  return AemReader(path, "AEM").read();
}

KvnItem to_kvn(const AttitudeEphemeris& aem) {
  KvnItem message = kvn_block("");
  message.items.push_back(kvn_assignment("CCSDS_AEM_VERS", aem.version));
  for (const std::string& comment : aem.comments) message.items.push_back(kvn_comment(comment));
  message.items.push_back(kvn_assignment("CREATION_DATE", aem.creation_date));
  message.items.push_back(kvn_assignment("ORIGINATOR", aem.originator));
  for (const Segment& segment : aem.segments) {
    KvnItem meta = kvn_block("META");
    for (const std::string& comment : segment.comments) meta.items.push_back(kvn_comment(comment));
    for (const Keyword& keyword : keywords) {
      const std::string& value = segment.*keyword.member;
      if (!value.empty()) meta.items.push_back(kvn_assignment(keyword.name, value));
    }
    KvnItem data = kvn_block("DATA");
    for (const AttitudeEphemeris::Row& row : segment.rows) {
      std::string line = row.epoch;
      for (const double x : row.values) line += " " + shortest(x);
      data.items.push_back(kvn_data(line));
    }
    message.items.push_back(std::move(meta));
    message.items.push_back(std::move(data));
  }
  return message;
}

void write_aem(const std::filesystem::path& path, const AttitudeEphemeris& aem) {
  write_file_whole(path, kvn_text(to_kvn(aem)));
}

AttitudeEphemeris make_aem(const std::vector<PlatformState>& states, const std::string& epoch,
                           const std::string& object_name, const std::string& creation_date) {
  const Epoch zero = epoch_of(epoch, {});
  AttitudeEphemeris aem;
  aem.creation_date = creation_date;
  aem.originator = "PHOTORQUE";
  Segment segment;
  segment.object_name = object_name;
  segment.object_id = "NONE";
  segment.center_name = "EARTH";
  segment.ref_frame_a = "LAB";
  segment.ref_frame_b = "SC_BODY_1";
  segment.quaternion_type = "LAST";
  segment.comments = {"LAB: x east, y north, z up; the quaternion rotates body vectors into it"};
  for (const PlatformState& state : states) {
    const Quat& q = state.lab_from_body;
    segment.rows.push_back({epoch_text(zero.after(state.time_s)), {q.x(), q.y(), q.z(), q.w()}});
  }
  if (!segment.rows.empty()) {
    segment.start_time = segment.rows.front().epoch;
    segment.stop_time = segment.rows.back().epoch;
  }
  aem.segments.push_back(std::move(segment));
  return aem;
}

}  // namespace photorque
