#include <filesystem>

#include "core/provenance.h"
#include "core/text/parse.h"
#include "scenes/gltf/file/document.h"

namespace photorque::gltf {
namespace {

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;  // '-' and '_': the alphabet for URLs, RFC 4648 section 5
  if (c == '/' || c == '_') return 63;
  return -1;
}

// Decodes base64 (RFC 4648), padding optional. Empty if a character or the length is invalid.
std::optional<std::string> base64_decoded(std::string_view text) {
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::string decoded;
  decoded.reserve(text.size() / 4 * 3 + 2);
  uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const int digit = base64_digit(c);
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<uint32_t>(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    decoded += static_cast<char>(bits >> held & 0xFF);
  }
  return decoded;
}

// A short excerpt of a URI for messages: data URIs can have megabytes.
std::string excerpt(const std::string& uri) {
  return describe_json(nlohmann::json(uri));
}

class Loader {
 public:
  Loader(std::optional<std::string_view> binary, bool is_glb, const std::string& file,
         const GltfOpen& open, MemoryBudget* budget)
      : binary_(binary), is_glb_(is_glb), file_(file), open_(open), budget_(budget) {}

  std::string uri(const UriHolder& holder) {
    where_ = holder.where;
    const auto uri = holder.object.find("uri");
    if (uri == holder.object.end() || !uri->is_string()) {
      throw wrong("uri", "nothing", "a text, or a bufferView");
    }
    return resource(uri->get_ref<const std::string&>(), holder.media_types);
  }

  Buffers load(const nlohmann::json& list) {
    for (size_t i = 0; i < list.size(); ++i) {
      where_ = pointer("buffers", i);
      Buffer buffer{list[i]["byteLength"].get<uint64_t>(), bytes(list[i], i)};
      if (buffer.bytes && buffer.bytes->size() < buffer.byte_length) {
        throw wrong(
            "byteLength", std::to_string(buffer.byte_length),
            "at most the " + std::to_string(buffer.bytes->size()) + " bytes that are there");
      }
      loaded_.buffers.push_back(std::move(buffer));
    }
    return std::move(loaded_);
  }

 private:
  InputError wrong(const char* member, const std::string& found,
                   const std::string& expected) const {
    return {{file_}, where_ + pointer(member), found, expected};
  }

  std::optional<std::string> bytes(const nlohmann::json& buffer, size_t i) {
    const auto uri = buffer.find("uri");
    if (uri != buffer.end()) {
      return resource(uri->get_ref<const std::string&>(),
                      {"application/octet-stream", "application/gltf-buffer"});
    }
    if (!is_glb_ || i != 0) return std::nullopt;
    if (!binary_) throw wrong("uri", "neither it nor a BIN chunk", "one of them");
    budget_->charge(binary_->size(), 1, where_);
    return std::string(*binary_);
  }

  // Bytes of a file or of a data URI (RFC 2397). `types` are the media types allowed by section
  // 3.6.1.1 of the specification.
  std::string resource(const std::string& uri, const std::array<std::string_view, 2>& types) {
    if (!uri.starts_with("data:")) return external(uri);
    const size_t comma = uri.find(',');
    if (comma == std::string::npos) throw wrong("uri", excerpt(uri), "a data URI with a comma");
    std::string type = lower_case(std::string_view(uri).substr(5, comma - 5));
    const std::string_view data = std::string_view(uri).substr(comma + 1);
    constexpr std::string_view marker = ";base64";
    const bool base64 = type.ends_with(marker);
    if (base64) type.resize(type.size() - marker.size());
    if (!type.empty() && type != types[0] && type != types[1]) {
      throw wrong("uri", "media type \"" + type + "\"",
                  std::string(types[0]) + " or " + std::string(types[1]));
    }
    budget_->charge(data.size(), 1, where_ + "/uri");
    const std::optional<std::string> decoded =
        base64 ? base64_decoded(data) : percent_decoded(data);
    if (!decoded) {
      throw wrong("uri", excerpt(uri),
                  std::string("data in ") + (base64 ? "base64" : "percent encoding"));
    }
    return *decoded;
  }

  // Relative path of an external file. Whether it may leave the model's folder is checked where
  // files are opened.
  std::string checked_path(const std::string& uri) const {
    const std::string expected = "a relative path inside the model's folder";
    const std::optional<std::string> decoded = percent_decoded(uri);
    if (!decoded || decoded->empty() || decoded->find('\0') != std::string::npos) {
      throw wrong("uri", excerpt(uri), expected);
    }
    const std::string first = decoded->substr(0, decoded->find_first_of("/\\"));
    const std::filesystem::path path = std::filesystem::path(*decoded).lexically_normal();
    if (first.find(':') != std::string::npos || decoded->find('\\') != std::string::npos ||
        path.is_absolute()) {
      throw wrong("uri", excerpt(uri), expected);
    }
    return path.generic_string();
  }

  std::string external(const std::string& uri) {
    const std::string path = checked_path(uri);
    std::optional<std::string> found = open_(path);
    if (!found) throw wrong("uri", excerpt(uri) + ", which does not exist", "an existing file");
    budget_->charge(found->size(), 1, where_ + "/uri");
    loaded_.inputs.emplace_back(path, content_hash(*found));
    return std::move(*found);
  }

  std::string where_;  // of the part that is being loaded, a JSON pointer
  std::optional<std::string_view> binary_;
  bool is_glb_;
  const std::string& file_;
  const GltfOpen& open_;
  MemoryBudget* budget_;
  Buffers loaded_;
};

}  // namespace

Buffers load_buffers(const nlohmann::json& document, std::optional<std::string_view> binary,
                     bool is_glb, const std::string& file, const GltfOpen& open,
                     MemoryBudget* budget) {
  const auto list = document.find("buffers");
  if (list == document.end()) return {};
  return Loader(binary, is_glb, file, open, budget).load(*list);
}

std::string load_uri(const UriHolder& holder, const std::string& file, const GltfOpen& open,
                     MemoryBudget* budget) {
  return Loader(std::nullopt, false, file, open, budget).uri(holder);
}

}  // namespace photorque::gltf
