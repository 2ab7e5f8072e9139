// Messages of attitude and orbit in XML. Source: CCSDS 505.0-B-3 (2023), NDM/XML.
#include <algorithm>
#include <array>
#include <pugixml.hpp>

#include "attitude/recordings/kvn.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

// Position of an element in a row. KVN has a fixed order, with the epoch first and the scalar last;
// XML has not. Other elements follow in the order of the file.
size_t place_of(const std::string& element) {
  constexpr std::array first = {"EPOCH",  "Q1",     "Q2",     "Q3",     "QC",     "Q1_DOT",
                                "Q2_DOT", "Q3_DOT", "QC_DOT", "X",      "Y",      "Z",
                                "X_DOT",  "Y_DOT",  "Z_DOT",  "X_DDOT", "Y_DDOT", "Z_DDOT"};
  return static_cast<size_t>(std::ranges::find(first, element) - first.begin());
}

// Elements of the data of attitude parameters, and the equivalent blocks of KVN. The names of the
// angular velocity and of version 1 differ.
constexpr std::array<std::array<const char*, 2>, 7> parameter_blocks = {
    {{"quaternionState", "QUAT"},
     {"eulerAngleState", "EULER"},
     {"eulerElementsThree", "EULER"},
     {"angularVelocity", "ANGVEL"},
     {"spin", "SPIN"},
     {"eulerElementsSpin", "SPIN"},
     {"inertia", "INERTIA"}}};

class XmlMessage {
 public:
  explicit XmlMessage(const std::filesystem::path& path) : path_(path), bytes_(read_file(path)) {
    const pugi::xml_parse_result parsed = document_.load_buffer(bytes_.data(), bytes_.size());
    if (!parsed) throw error(line_at(parsed.offset), parsed.description(), "well-formed XML");
  }

  KvnItem read(const std::string& upper_kind) const {
    const std::string kind = lower_case(upper_kind);
    const pugi::xml_node root = document_.document_element();
    const bool is_combined = root.name() == std::string("ndm");
    const pugi::xml_node node = is_combined ? root.child(kind.c_str()) : root;
    if (node.name() != kind || (is_combined && node.next_sibling(kind.c_str()))) {
      const char* several = node.name() == kind ? " with several <" : " without an <";
      throw error(line_of(root),
                  "<" + std::string(root.name()) + ">" + (is_combined ? several + kind + ">" : ""),
                  "one <" + kind + ">");
    }
    KvnItem message;
    message.items.push_back({.kind = KvnItem::Kind::assignment,
                             .key = "CCSDS_" + upper_kind + "_VERS",
                             .value = node.attribute("version").value()});
    add_assignments(node.child("header"), message);
    for (const pugi::xml_node& segment : node.child("body").children("segment")) {
      if (kind == "apm") {
        add_assignments(segment.child("metadata"), message);
        add_parameters(segment.child("data"), message);
        continue;
      }
      KvnItem meta{.key = "META", .line = line_of(segment.child("metadata"))}, data{.key = "DATA"};
      add_assignments(segment.child("metadata"), meta);
      const char* row = kind == "aem" ? "attitudeState" : "stateVector";
      for (const pugi::xml_node& state : segment.child("data").children(row)) {
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
      // Rows have the scalar last in any file, so QUATERNION_TYPE is left out.
      if (node.type() != pugi::node_element || name == "QUATERNION_TYPE" || name == "COMMENT")
        continue;
      block.items.push_back({.kind = KvnItem::Kind::assignment,
                             .key = name,
                             .value = node.child_value(),
                             .line = line_of(node)});
    }
  }

  // The elements below `node` without child elements, in the order of the file, without comments.
  static std::vector<pugi::xml_node> leaves_of(const pugi::xml_node& node) {
    std::vector<pugi::xml_node> leaves;
    const auto gather = [&leaves](const auto& self, const pugi::xml_node& at, int depth) -> void {
      constexpr int deepest = 8;
      const bool has_elements = std::ranges::any_of(
          at.children(), [](const auto& child) { return child.type() == pugi::node_element; });
      if (!has_elements && at.name() != std::string("COMMENT")) leaves.push_back(at);
      if (!has_elements || depth > deepest) return;
      for (const pugi::xml_node& child : at.children()) {
        if (child.type() == pugi::node_element) self(self, child, depth + 1);
      }
    };
    gather(gather, node, 0);
    return leaves;
  }

  void add_parameters(const pugi::xml_node& data, KvnItem& message) const {
    for (const pugi::xml_node& node : data.children()) {
      const std::string name = node.name();
      if (name == "EPOCH") message.items.push_back(assignment_of(node));
      const auto known = std::ranges::find_if(
          parameter_blocks, [&name](const auto& names) { return name == names[0]; });
      if (known == parameter_blocks.end()) continue;
      KvnItem block{.key = (*known)[1], .line = line_of(node)};
      for (const pugi::xml_node& leaf : leaves_of(node)) block.items.push_back(assignment_of(leaf));
      message.items.push_back(std::move(block));
    }
  }

  // In version 1, an attribute names the angles and rates of a rotation.
  KvnItem assignment_of(const pugi::xml_node& leaf) const {
    std::string name = leaf.name();
    for (const char* attribute : {"angle", "rate"}) {
      if (name.starts_with("rotation") && leaf.attribute(attribute)) {
        name = leaf.attribute(attribute).value();
      }
    }
    return {.kind = KvnItem::Kind::assignment,
            .key = name,
            .value = leaf.child_value(),
            .unit = leaf.attribute("units").value(),
            .line = line_of(leaf)};
  }

  KvnItem row_of(const pugi::xml_node& state) const {
    std::vector<pugi::xml_node> leaves = leaves_of(state);
    std::ranges::stable_sort(leaves, {}, [](const auto& leaf) { return place_of(leaf.name()); });
    const std::string line = joined_text(
        leaves, " ", [&](const pugi::xml_node& leaf) { return std::string(leaf.child_value()); });
    return {.kind = KvnItem::Kind::data, .value = line, .line = line_of(state)};
  }

  std::filesystem::path path_;
  std::string bytes_;
  pugi::xml_document document_;
};

}  // namespace

KvnItem read_ndm_xml(const std::filesystem::path& path, const std::string& kind) {
  return XmlMessage(path).read(kind);
}

}  // namespace photorque
