// CCSDS messages in keyword-value notation (KVN) or XML: blocks of assignments and data lines, as
// text in its order. Comments are left out.
//
// Sources: CCSDS 504.0-B-2 (2024), section 7; CCSDS 505.0-B-3 (2023).
#pragma once

#include <array>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "attitude/environment/epoch.h"
#include "core/errors.h"
#include "core/transform.h"

namespace photorque {

struct KvnItem {
  enum class Kind { assignment, data, block };
  Kind kind = Kind::block;
  std::string key = {};             // of an assignment; of a block: its name, "META"
  std::string value = {};           // of an assignment; a data line
  std::string unit = {};            // of an assignment, without brackets; empty: none
  std::vector<KvnItem> items = {};  // of a block
  int line = 0;                     // in the file

  // The first assignment in this block of the first of `names` that it has, or null.
  const KvnItem* find(std::initializer_list<std::string_view> names) const;
};

// Reads an attitude ephemeris (kind "AEM"), attitude parameters ("APM") or an orbit ephemeris
// ("OEM") in XML as the equivalent blocks, with the scalar of quaternions last. InputError unless
// the file holds one of this kind.
KvnItem read_ndm_xml(const std::filesystem::path& path, const std::string& kind);
// The kinds of CCSDS messages in a file, as "AEM", by the first line with content of KVN or by the
// elements of XML. None for another file and for one that cannot be read.
std::vector<std::string> kinds_of_messages(const std::filesystem::path& path);
// The form in which texts of messages are compared: upper case, with underscores for blanks.
std::string kvn_word(std::string_view text);

// A message in KVN or XML and its file. Names of frames, types and time systems are converted
// by kvn_word(). The functions throw InputError with the line of the item at fault.
struct MessageFile {
  // `kind`: "AEM", "APM" or "OEM". InputError for a block without an end and for a line of an
  // unknown kind.
  MessageFile(const std::filesystem::path& file, const std::string& kind);

  std::filesystem::path path;
  KvnItem message;

  InputError error(const KvnItem& at, const std::string& key, const std::string& found,
                   const std::string& expected) const;
  const KvnItem& required(const KvnItem& block,
                          std::initializer_list<std::string_view> names) const;
  // A row of data: an epoch, as written, and numbers.
  struct Row {
    std::string epoch;
    std::vector<double> numbers;
  };
  Row row(const KvnItem& item) const;
  // `text` of the item `at` as a calendar time, and such a time in a time system as UTC.
  Epoch epoch(const std::string& text, const std::string& key, const KvnItem& at) const;
  Epoch utc(const Epoch& time, const std::string& system, const KvnItem& at) const;
  // A quaternion of the item `at`, normalised. InputError if its norm differs from one by more than
  // 1 %.
  Quat unit(const Quat& q, const KvnItem& at, const std::string& key) const;
};

// The axes (0 for x) of three successive rotations, written as "321" or "ZYX". Nothing for another
// text.
std::optional<std::array<int, 3>> axes_of_sequence(std::string_view sequence);
// Successive rotations about these axes, from `first` on, each about an axis of the frame that the
// previous rotations rotated.
Quat successive_rotations(const std::array<int, 3>& axes, const Vec3& angles_rad, int first = 0);

// Reference frames. Names are in upper case, as read by MessageFile.
// Sources: SANA registries of celestial body reference frames and of spacecraft body reference
// frames.

// Axes of a reference frame for orbits about the Earth.
enum class FrameAxes {
  J2000,    // inertial, equator of J2000: EME2000, J2000, GCRF, ICRF…
  of_date,  // inertial, equator and equinox of date: TOD, MOD, TEME
  earth,    // rotating with the Earth: ITRF…
  unknown,
};
FrameAxes axes_of_frame(std::string_view frame);

// Frames A and B of a rotation. One is fixed in the body, the other one is the lab's.
struct FramePair {
  // InputError unless one frame is a body's and the other one is inertial or LAB.
  FramePair(const std::string& frame_a, const std::string& frame_b, const InputLocation& where);

  std::string a, b;
  bool is_from_body;  // A is fixed in the body
  const std::string& lab() const { return is_from_body ? b : a; }
};

// Whether the axes `frame` of an angular velocity are those of A, not of B. They are named or
// stated as REF_FRAME_A or REF_FRAME_B. InputError for another frame.
bool are_axes_of_a(const std::string& frame, const std::string& a, const std::string& b,
                   const InputLocation& where);

}  // namespace photorque
