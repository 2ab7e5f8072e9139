// CCSDS messages in keyword-value notation (KVN) or XML: blocks of assignments, comments and data
// lines. Everything is stored as text in its order.
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

namespace photorque {

struct KvnItem {
  enum class Kind { comment, assignment, data, block };
  Kind kind = Kind::block;
  std::string key;             // of an assignment; of a block: its name, "META"
  std::string value;           // of an assignment; text of a comment; a data line
  std::string unit;            // of an assignment, without brackets; empty: none
  std::vector<KvnItem> items;  // of a block
  int line = 0;                // in the file

  // The first assignment in this block of the first of `names` that it has, or null.
  const KvnItem* find(std::initializer_list<std::string_view> names) const;
};

KvnItem kvn_comment(const std::string& text);
KvnItem kvn_assignment(const std::string& key, const std::string& value,
                       const std::string& unit = "");
KvnItem kvn_data(const std::string& line);
KvnItem kvn_block(const std::string& name);

// Reads a message in KVN or XML as one block without a name. InputError for a block without an end
// and for a line of an unknown kind.
KvnItem read_message(const std::filesystem::path& path);
// Reads a message in XML (attitude ephemeris, attitude parameters, orbit ephemeris) as the
// equivalent blocks, with the scalar of quaternions last. InputError for other messages.
KvnItem read_ndm_xml(const std::filesystem::path& path);
// Whether the first line with content is that of a KVN message of this kind ("AEM"), or whether the
// XML contains the element of one. False for a file that cannot be read.
bool is_message(const std::filesystem::path& path, const std::string& kind);
std::string kvn_text(const KvnItem& message);

// A message and its file. The functions throw InputError with the line of the item at fault.
struct MessageFile {
  explicit MessageFile(const std::filesystem::path& file);

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
};

// Whether a frame is that of the body or of a part of it.
bool is_body_frame(std::string_view frame);

// The axes (0 for x) of three successive rotations, written as "321" or "ZYX". Nothing for another
// text.
std::optional<std::array<int, 3>> axes_of_sequence(std::string_view sequence);

}  // namespace photorque
