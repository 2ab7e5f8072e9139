// CCSDS messages in keyword-value notation (KVN) or XML: blocks of assignments, comments and data
// lines. Everything is stored as text in its order.
//
// Sources: CCSDS 504.0-B-2 (2024), section 7; CCSDS 505.0-B-3 (2023).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace photorque {

struct KvnItem {
  enum class Kind { comment, assignment, data, block };
  Kind kind = Kind::block;
  std::string key;             // of an assignment; of a block: its name, "META"
  std::string value;           // of an assignment; text of a comment; a data line
  std::string unit;            // of an assignment, without brackets; empty: none
  std::vector<KvnItem> items;  // of a block
  int line = 0;                // in the file

  // The value of the first assignment of `name` in this block, or null.
  const std::string* find(std::string_view name) const;
};

KvnItem kvn_comment(const std::string& text);
KvnItem kvn_assignment(const std::string& key, const std::string& value,
                       const std::string& unit = "");
KvnItem kvn_data(const std::string& line);
KvnItem kvn_block(const std::string& name);

// Reads a message as one block without a name. InputError for a block without an end and for a line
// of an unknown kind.
KvnItem read_kvn(const std::filesystem::path& path);
// Reads a message in XML (attitude ephemeris, attitude parameters, orbit ephemeris) as the
// equivalent blocks, with the scalar of quaternions last. InputError for other messages.
KvnItem read_ndm_xml(const std::filesystem::path& path);
// Reads a message in KVN or XML.
KvnItem read_message(const std::filesystem::path& path);
// Whether the first line with content is that of a KVN message of this kind ("AEM"), or whether the
// XML contains the element of one. False for a file that cannot be read.
bool is_message(const std::filesystem::path& path, const std::string& kind);
std::string kvn_text(const KvnItem& message);
void write_kvn(const std::filesystem::path& path, const KvnItem& message);

// All words from index `first` on as numbers; InputError (at `path`, `line`) if one is no number.
std::vector<double> kvn_numbers(const std::vector<std::string_view>& words, size_t first,
                                const std::filesystem::path& path, int line);

}  // namespace photorque
