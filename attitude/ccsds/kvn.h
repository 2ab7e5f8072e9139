// CCSDS messages in keyword-value notation (KVN): blocks of assignments, comments and data lines.
//
// Everything is kept as text in its order, so that a message written back says the same in every
// digit; what it means is the business of aem.h.
// Source: CCSDS 504.0-B-2 (2024), section 7.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace photorque {

struct KvnItem {
  enum class Kind { comment, assignment, data, block };
  Kind kind = Kind::block;
  std::string key;             // of an assignment; name of a block: "META"
  std::string value;           // of an assignment; text of a comment; a data line
  std::string unit;            // of an assignment, without brackets; empty: none
  std::vector<KvnItem> items;  // of a block
  int line = 0;                // in the file; not compared

  bool operator==(const KvnItem& other) const;

  // The value of the first assignment of `name` in this block, or null.
  const std::string* find(std::string_view name) const;
};

KvnItem kvn_comment(const std::string& text);
KvnItem kvn_assignment(const std::string& key, const std::string& value,
                       const std::string& unit = "");
KvnItem kvn_data(const std::string& line);
KvnItem kvn_block(const std::string& name);

// The message as one nameless block. InputError for blocks that do not close and lines that are
// none of the kinds.
KvnItem read_kvn(const std::filesystem::path& path);
std::string kvn_text(const KvnItem& message);
void write_kvn(const std::filesystem::path& path, const KvnItem& message);

// All words from index `first` on as numbers; InputError (at `path`, `line`) when one is none.
std::vector<double> kvn_numbers(const std::vector<std::string_view>& words, size_t first,
                                const std::filesystem::path& path, int line);

}  // namespace photorque
