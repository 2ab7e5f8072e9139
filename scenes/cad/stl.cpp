#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <optional>
#include <unordered_map>

#include "core/little_endian.h"
#include "core/text/parse.h"
#include "scenes/cad/part.h"

namespace photorque::cad {
namespace {

constexpr size_t stl_header_bytes = 80, count_bytes = 4, facet_bytes = 50;

// Merges corners with identical coordinates into one vertex.
class CornerPool {
 public:
  explicit CornerPool(Mesh& mesh) : mesh_(mesh) {}

  uint32_t add(const Vec3& at) {
    std::string key(sizeof(double) * 3, '\0');
    const Vec3 plain = at + Vec3::Zero();  // turns −0 into 0
    std::memcpy(key.data(), plain.data(), key.size());
    const auto [entry, is_new] =
        places_.try_emplace(std::move(key), static_cast<uint32_t>(places_.size()));
    if (is_new) mesh_.vertices_m.push_back(plain);
    return entry->second;
  }

 private:
  Mesh& mesh_;
  std::unordered_map<std::string, uint32_t> places_;
};

// Whether the length is that of a binary file. Many binary files begin with "solid", too.
bool has_binary_length(std::string_view bytes) {
  if (bytes.size() < stl_header_bytes + count_bytes) return false;
  const uint64_t count = little_endian_32(bytes, stl_header_bytes);
  return bytes.size() == stl_header_bytes + count_bytes + facet_bytes * count;
}

std::vector<Part> read_binary(std::string_view bytes, const std::string& file,
                              const std::string& name) {
  const uint32_t count = little_endian_32(bytes, stl_header_bytes);
  if (count > most_triangles) {
    throw InputError({file}, "facets", std::to_string(count),
                     "at most " + std::to_string(most_triangles));
  }
  Part part{name, name, {}};
  CornerPool pool(part.mesh);
  part.mesh.triangles.reserve(count);
  for (uint32_t facet = 0; facet < count; ++facet) {
    const size_t start = stl_header_bytes + count_bytes + facet_bytes * facet;
    std::array<uint32_t, 3> triangle{};
    for (size_t corner = 0; corner < 3; ++corner) {
      Vec3 at;
      for (size_t k = 0; k < 3; ++k) {
        // Skips the normal.
        at[static_cast<Eigen::Index>(k)] =
            std::bit_cast<float>(little_endian_32(bytes, start + 12 + 12 * corner + 4 * k));
      }
      if (!at.allFinite()) {
        throw InputError({file}, "facet " + std::to_string(facet + 1),
                         "a corner that is not finite", "three numbers");
      }
      triangle[corner] = pool.add(at);
    }
    part.mesh.triangles.push_back(triangle);
  }
  return {std::move(part)};
}

bool same_word(std::string_view word, std::string_view keyword) {
  return std::ranges::equal(word, keyword, [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == b;
  });
}

// Reads the words of a text file one by one. Keywords are accepted in any case. Line ends count as
// blanks, except that a name ends at the end of its line.
class TextReader {
 public:
  TextReader(std::string_view text, const std::string& file, const std::string& name)
      : lines_(lines_of(text)), name_(name), where_{file} {}

  std::vector<Part> read() {
    while (has_word()) {
      if (is_next("solid")) {
        begin();
      } else if (ends("solid")) {
        if (is_next("end")) ++word_;
        end();
        read_name(false);
      } else if (is_next("facet")) {
        read_facet();
      } else {
        throw wrong("facet, solid or endsolid");
      }
    }
    end();
    return std::move(parts_);
  }

 private:
  InputError wrong(const std::string& expected) {
    const std::string found = has_word() ? in_quotes(words_[word_]) : "the end of the file";
    return {where_, "", found, expected};
  }

  bool has_word() {
    while (word_ == words_.size() && line_ < lines_.size()) {
      words_ = words_of(trimmed(lines_[line_++]));
      word_ = 0;
      where_.line = static_cast<int>(line_);
    }
    return word_ < words_.size();
  }

  bool is_next(std::string_view keyword) { return has_word() && same_word(words_[word_], keyword); }

  void expect(const char* keyword) {
    if (!is_next(keyword)) throw wrong(keyword);
    ++word_;
  }

  // Whether the next word ends a block of this kind; it may be written as two words.
  bool ends(const std::string& block) {
    return is_next("end" + block) ||
           (is_next("end") && word_ + 1 < words_.size() && same_word(words_[word_ + 1], block));
  }

  void expect_end(const std::string& block) {
    if (!ends(block)) throw wrong("end" + block);
    word_ += is_next("end") ? 2 : 1;
  }

  // Whether a word on this line begins a facet instead of belonging to a name.
  bool begins_facet(size_t word) const {
    return same_word(words_[word], "facet") && word + 1 < words_.size() &&
           (same_word(words_[word + 1], "normal") || same_word(words_[word + 1], "outer"));
  }

  // The name after a keyword: the rest of the line; in a file of one line, the text up to the next
  // facet or solid.
  std::string read_name(bool opens) {
    const auto ends = [&](size_t word) {
      return opens ? begins_facet(word) : same_word(words_[word], "solid");
    };
    std::string name;
    for (++word_; word_ < words_.size() && !ends(word_); ++word_) {
      name += (name.empty() ? "" : " ") + std::string(words_[word_]);
    }
    return name;
  }

  void begin() {
    end();
    const std::string name = read_name(true);
    part_.emplace(Part{name.empty() ? name_ : name, name_, {}});
    pool_.emplace(part_->mesh);
  }

  void end() {
    if (part_ && !part_->mesh.triangles.empty()) parts_.push_back(std::move(*part_));
    pool_.reset();
    part_.reset();
  }

  Vec3 read_corner() {
    expect("vertex");
    Vec3 at;
    for (int k = 0; k < 3; ++k, ++word_) {
      if (!has_word() || is_next("vertex") || ends("loop")) {
        throw InputError(where_, "vertex", std::to_string(k) + " values", "three");
      }
      at[k] = require_number(words_[word_], where_, "vertex");
    }
    return at;
  }

  void read_facet() {
    if (!part_) throw wrong("solid");
    constexpr int most_normal_words = 4;  // "normal" and its three numbers
    expect("facet");
    for (int k = 0; k < most_normal_words && has_word() && !is_next("outer"); ++k) ++word_;
    expect("outer");
    expect("loop");
    std::array<uint32_t, 3> triangle{};
    for (uint32_t& corner : triangle) corner = pool_->add(read_corner());
    expect_end("loop");
    expect_end("facet");
    if (++triangles_ > most_triangles) {
      throw InputError(where_, "facets", "more", "at most " + std::to_string(most_triangles));
    }
    part_->mesh.triangles.push_back(triangle);
  }

  std::vector<std::string_view> lines_, words_;
  size_t line_ = 0, word_ = 0, triangles_ = 0;
  std::string name_;
  InputLocation where_;
  std::optional<Part> part_;
  std::optional<CornerPool> pool_;
  std::vector<Part> parts_;
};

// Whether the file is text. Both kinds may begin with "solid", but a binary file contains zeros
// before its end.
bool is_text(std::string_view bytes) {
  const std::string_view start = bytes.substr(0, 1000);
  const size_t zero = start.find('\0');
  return (zero == std::string_view::npos ||
          bytes.find_first_not_of('\0', zero) == std::string_view::npos) &&
         same_word(trimmed(start).substr(0, 5), "solid");
}

// Text of another kind: a page of the web, a model in another format, a note above the first solid.
bool is_other_text(std::string_view bytes) {
  const std::string_view start = bytes.substr(0, 1000);
  return !start.empty() && std::ranges::all_of(start, [](char c) {
    return static_cast<unsigned char>(c) >= 0x20 ||
           std::isspace(static_cast<unsigned char>(c)) != 0;
  });
}

}  // namespace

std::vector<Part> read_stl(std::string_view bytes, const std::string& file,
                           const std::string& name) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (bytes.starts_with(byte_order_mark) && !has_binary_length(bytes))
    bytes.remove_prefix(byte_order_mark.size());
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    throw InputError({file}, "", "text in UTF-16", "text in ASCII or UTF-8, or binary STL");
  }
  std::vector<Part> parts;
  if (has_binary_length(bytes)) {
    parts = read_binary(bytes, file, name);
  } else if (is_text(bytes)) {
    constexpr std::string_view ends_of_text = std::string_view("\0\x1A", 2);
    bytes = bytes.substr(0, bytes.find_first_of(ends_of_text));
    parts = TextReader(bytes, file, name).read();
  } else if (is_other_text(bytes)) {
    const std::string_view start = trimmed(bytes.substr(0, 40));
    throw InputError(
        {file, 1}, "",
        "text that begins with " + in_quotes(start.substr(0, start.find_first_of(" \t\r\n"))),
        "an STL file: text that begins with solid, or binary data");
  } else {
    const bool has_count = bytes.size() >= stl_header_bytes + count_bytes;
    throw InputError(
        {file}, "", std::to_string(bytes.size()) + " bytes",
        has_count ? "84 + 50 × " + std::to_string(little_endian_32(bytes, stl_header_bytes)) +
                        " bytes, the facets that the header counts, or text that begins with solid"
                  : "an STL file: text that begins with solid, or at least 84 bytes");
  }
  if (parts.empty() || parts.front().mesh.triangles.empty()) {
    throw InputError({file}, "", "no facet", "at least one");
  }
  return parts;
}

}  // namespace photorque::cad
