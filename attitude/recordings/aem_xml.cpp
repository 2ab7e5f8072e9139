// Attitude ephemeris messages in XML. Source: CCSDS 505.0-B-3 (2023), NDM/XML.
#include <algorithm>
#include <array>
#include <pugixml.hpp>

#include "attitude/recordings/aem.h"
#include "core/errors.h"
#include "core/files.h"

namespace photorque {
namespace {

// Elements of an attitude whose order KVN fixes and XML does not: epoch, scalar last. All others
// follow in the order of the file.
size_t place_of(const std::string& element) {
  constexpr std::array first = {"EPOCH",  "Q1",     "Q2",     "Q3",    "QC",
                                "Q1_DOT", "Q2_DOT", "Q3_DOT", "QC_DOT"};
  return static_cast<size_t>(std::ranges::find(first, element) - first.begin());
}

class XmlMessage {
 public:
  explicit XmlMessage(const std::filesystem::path& path) : path_(path), bytes_(read_file(path)) {
    const pugi::xml_parse_result parsed = document_.load_buffer(bytes_.data(), bytes_.size());
    if (!parsed) throw error(line_at(parsed.offset), parsed.description(), "well-formed XML");
  }

  KvnItem read() const {
    const pugi::xml_node root = document_.document_element();
    const pugi::xml_node aem = root.name() == std::string("ndm") ? root.child("aem") : root;
    if (aem.name() != std::string("aem")) {
      throw error(line_of(root), "no <aem>", "an attitude ephemeris message");
    }
    KvnItem message = kvn_block("");
    message.items.push_back(kvn_assignment("CCSDS_AEM_VERS", aem.attribute("version").value()));
    add_assignments(aem.child("header"), message);
    for (const pugi::xml_node& segment : aem.child("body").children("segment")) {
      KvnItem meta = kvn_block("META"), data = kvn_block("DATA");
      meta.line = line_of(segment.child("metadata"));
      add_assignments(segment.child("metadata"), meta);
      for (const pugi::xml_node& state : segment.child("data").children("attitudeState")) {
        data.items.push_back(row_of(state));
      }
      message.items.push_back(std::move(meta));
      message.items.push_back(std::move(data));
    }
    return message;
  }

 private:
  InputError error(int line, const std::string& found, const std::string& expected) const {
    return {{path_.string(), line}, "", found, expected};
  }
  int line_at(std::ptrdiff_t offset) const {
    const auto end = bytes_.begin() + std::clamp<std::ptrdiff_t>(
                                          offset, 0, static_cast<std::ptrdiff_t>(bytes_.size()));
    return 1 + static_cast<int>(std::count(bytes_.begin(), end, '\n'));
  }
  int line_of(const pugi::xml_node& node) const { return line_at(node.offset_debug()); }

  void add_assignments(const pugi::xml_node& parent, KvnItem& block) const {
    for (const pugi::xml_node& node : parent.children()) {
      const std::string name = node.name();
      // Rows have the scalar last, in any file.
      if (node.type() != pugi::node_element || name == "QUATERNION_TYPE") continue;
      KvnItem item = name == "COMMENT" ? kvn_comment(node.child_value())
                                       : kvn_assignment(name, node.child_value());
      item.line = line_of(node);
      block.items.push_back(std::move(item));
    }
  }

  KvnItem row_of(const pugi::xml_node& state) const {
    std::vector<pugi::xml_node> leaves;
    const auto gather = [&leaves](const auto& self, const pugi::xml_node& node, int depth) -> void {
      constexpr int deepest = 8;
      const bool has_elements = std::ranges::any_of(
          node.children(), [](const auto& child) { return child.type() == pugi::node_element; });
      if (!has_elements && node.name() != std::string("COMMENT")) leaves.push_back(node);
      if (!has_elements || depth > deepest) return;
      for (const pugi::xml_node& child : node.children()) {
        if (child.type() == pugi::node_element) self(self, child, depth + 1);
      }
    };
    gather(gather, state, 0);
    std::ranges::stable_sort(leaves, {}, [](const auto& leaf) { return place_of(leaf.name()); });
    std::string line;
    for (const pugi::xml_node& leaf : leaves) {
      line += (line.empty() ? "" : " ") + std::string(leaf.child_value());
    }
    KvnItem row = kvn_data(line);
    row.line = line_of(state);
    return row;
  }

  std::filesystem::path path_;
  std::string bytes_;
  pugi::xml_document document_;
};

}  // namespace

KvnItem read_aem_xml(const std::filesystem::path& path) {
  return XmlMessage(path).read();
}

}  // namespace photorque
