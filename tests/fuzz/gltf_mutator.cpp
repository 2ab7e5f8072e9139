// Changes of glTF files: values, members and items of the JSON are put in place of others, bytes of
// buffers are changed where they stand (in the second chunk, or in base64), and lengths are set
// right again, so that what is wrong is found behind the parser.
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "core/text/format.h"
#include "tests/base64.h"
#include "tests/fuzz/random_bytes.h"

namespace {

using nlohmann::json;
using photorque::fuzz::Chance;

constexpr std::array<const char*, 40> keys = {"accessors",  "bufferViews",   "buffers",
                                              "byteLength", "byteOffset",    "byteStride",
                                              "children",   "componentType", "count",
                                              "extensions", "extras",        "indices",
                                              "matrix",     "max",           "mesh",
                                              "min",        "mode",          "name",
                                              "nodes",      "normalized",    "attributes",
                                              "POSITION",   "TEXCOORD_0",    "rotation",
                                              "scale",      "translation",   "sparse",
                                              "values",     "type",          "uri",
                                              "weights",    "skin",          "targets",
                                              "photorque",  "absorptance",   "specular",
                                              "back",       "material",      "baseColorTexture",
                                              "light"};

constexpr std::array<double, 18> numbers = {0,    1,    -1,   2,    3,     4,      5120,
                                            5121, 5123, 5125, 5126, 1e308, 1e-308, 4294967295.0,
                                            1e18, 0.5,  255,  65536};

constexpr std::array<const char*, 10> words = {"VEC3",       "VEC2", "SCALAR", "MAT4", "TRIANGLES",
                                               "OCTAHEDRAL", "",     "data:,", "../x", "POSITION"};

// A file as its JSON and the following bytes.
struct Parts {
  json document;
  std::string chunk;
  bool binary = false;
};

uint32_t word_at(const std::string& bytes, size_t at) {
  uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

void add_word(std::string& bytes, size_t word) {
  const auto narrow = static_cast<uint32_t>(word);
  bytes.append(reinterpret_cast<const char*>(&narrow), sizeof narrow);
}

Parts parts_of(const std::string& bytes) {
  constexpr size_t head = 20, chunk_head = 8;
  Parts parts;
  std::string text = bytes;
  if (bytes.size() >= head && bytes.starts_with("glTF")) {
    const size_t length = std::min<size_t>(word_at(bytes, 12), bytes.size() - head);
    text = bytes.substr(head, length);
    parts.binary = true;
    if (bytes.size() > head + length + chunk_head) {
      parts.chunk = bytes.substr(head + length + chunk_head);
    }
  }
  parts.document = json::parse(text, nullptr, false);
  return parts;
}

std::string joined(const Parts& parts) {
  std::string text = parts.document.dump(-1, ' ', false, json::error_handler_t::replace);
  if (!parts.binary) return text;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string chunk = parts.chunk;
  chunk.resize((chunk.size() + 3) / 4 * 4, '\0');
  std::string bytes = "glTF";
  add_word(bytes, 2);
  add_word(bytes, 12 + 8 + text.size() + (chunk.empty() ? 0 : 8 + chunk.size()));
  add_word(bytes, text.size());
  bytes += "JSON" + text;
  if (chunk.empty()) return bytes;
  add_word(bytes, chunk.size());
  return bytes + std::string("BIN\0", 4) + chunk;
}

void collect(json& node, std::vector<json*>& all) {
  all.push_back(&node);
  if (!node.is_structured()) return;
  for (json& item : node) collect(item, all);
}

// Bytes in base64 stay base64.
std::string with_text_changed(const std::string& text) {
  const size_t comma = text.find(";base64,");
  if (!text.starts_with("data:") || comma == std::string::npos) {
    return photorque::fuzz::with_bytes_changed(text);
  }
  const size_t begin = comma + 8;
  const std::string bytes =
      photorque::fuzz::with_bytes_changed(photorque::test::bytes_of_base64(text.substr(begin)));
  return text.substr(0, begin) + photorque::base64(std::as_bytes(std::span(bytes)));
}

void change(json& document, Chance& chance) {
  std::vector<json*> all;
  collect(document, all);
  json& node = *chance.one_of(all);
  const json other = *chance.one_of(all);
  if (node.is_number() && chance.below(2) == 0) {
    node = chance.below(2) == 0 ? json(static_cast<int64_t>(chance.below(12)) - 2)
                                : json(chance.one_of(numbers));
  } else if (node.is_string() && chance.below(2) == 0) {
    node = with_text_changed(node.get<std::string>());
  } else if (node.is_object() && !node.empty() && chance.below(2) == 0) {
    auto member = node.begin();
    std::advance(member, static_cast<std::ptrdiff_t>(chance.below(node.size())));
    node.erase(member);
  } else if (node.is_object()) {
    node[chance.one_of(keys)] = other;
  } else if (node.is_array() && !node.empty() && chance.below(3) == 0) {
    node.erase(chance.below(node.size()));
  } else if (node.is_array()) {
    node.push_back(node.empty() || chance.below(3) == 0 ? other
                                                        : json(node[chance.below(node.size())]));
  } else if (chance.below(3) == 0) {
    node = chance.one_of(words);
  } else if (other.dump(-1, ' ', false, json::error_handler_t::replace).size() < 2000) {
    node = other;
  }
}

}  // namespace

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size,
                                          unsigned seed) {
  Chance chance(seed);
  if (chance.below(8) == 0) return LLVMFuzzerMutate(data, size, max_size);
  Parts parts = parts_of(std::string(reinterpret_cast<const char*>(data), size));
  if (parts.document.is_discarded()) return LLVMFuzzerMutate(data, size, max_size);
  if (!parts.chunk.empty() && chance.below(3) == 0) {
    parts.chunk = photorque::fuzz::with_bytes_changed(parts.chunk);
  } else {
    for (size_t left = 1 + chance.below(3); left > 0; --left) change(parts.document, chance);
  }
  const std::string bytes = joined(parts);
  if (bytes.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
  return photorque::fuzz::put(bytes, data, max_size);
}
