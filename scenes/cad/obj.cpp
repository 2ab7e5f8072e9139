#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>

#include "core/text/format.h"
#include "core/text/parse.h"
#include "scenes/cad/part.h"

namespace photorque::cad {
namespace {

// Largest number of corners of a face; the time of triangulation is proportional to its square.
constexpr size_t most_corners = 4096;

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& file, const std::string& name)
      : lines_(text, file), name_(name) {}

  std::vector<Part> read() {
    std::string_view line;
    while (next(line)) read_line();
    std::vector<Part> parts;
    for (const std::string& key : order_) {
      Part& part = parts_.at(key);
      if (!part.mesh.triangles.empty()) parts.push_back(std::move(part));
    }
    if (parts.empty()) throw InputError({lines_.where().file}, "", "no face", "at least one");
    return parts;
  }

 private:
  // A line that ends in a backslash continues in the next one.
  bool next(std::string_view& line) {
    if (!lines_.next(line)) return false;
    where_ = lines_.where();
    joined_.assign(line);
    while (joined_.ends_with('\\')) {
      joined_.back() = ' ';
      if (!lines_.next(line)) break;
      joined_ += line;
    }
    // Removes a comment.
    words_ = words_of(std::string_view(joined_).substr(0, joined_.find('#')));
    return true;
  }

  InputError wrong(const std::string& key, const std::string& found,
                   const std::string& expected) const {
    return {where_, key, found, expected};
  }

  void read_line() {
    if (words_.empty()) return;
    const std::string_view word = words_[0];
    if (word == "v") {
      read_vertex();
    } else if (word == "f" || word == "fo") {
      read_face();
    } else if (word == "o") {
      object_ = rest();
      part_ = nullptr;
    } else if (word == "g") {
      group_ = rest();
      part_ = nullptr;
    } else if (word == "usemtl") {
      material_ = rest();
      part_ = nullptr;
    } else if (word == "curv" || word == "curv2" || word == "surf") {
      throw wrong("", in_quotes(word), "faces: curves and surfaces are not read");
    }
  }

  std::string rest() const {
    return words_.empty() ? "" : joined_text(std::span(words_).subspan(1), " ");
  }

  // Reads x, y, z; a weight or colour after them is ignored.
  void read_vertex() {
    if (words_.size() < 4 || words_.size() > 8) {
      throw wrong("v", std::to_string(words_.size() - 1) + " values", "three");
    }
    Vec3 at;
    for (size_t k = 0; k < 3; ++k) {
      at[static_cast<Eigen::Index>(k)] = require_number(words_[k + 1], where_, "v");
    }
    vertices_.push_back(at);
  }

  // Index of the vertex of "7", "7/1", "7//3", "7/1/3" or "-1": counted from 1, or backwards from
  // the last.
  uint32_t vertex_of(std::string_view word) const {
    const std::string_view number = word.substr(0, word.find('/'));
    const std::optional<double> index = number_in(number);
    const auto count = static_cast<double>(vertices_.size());
    const double place = !index ? 0.0 : *index < 0.0 ? count + *index + 1.0 : *index;
    if (!index || *index != std::floor(*index) || !(place >= 1.0 && place <= count)) {
      throw wrong("f", in_quotes(word),
                  vertices_.empty() ? "vertices before their faces"
                                    : "a vertex from 1 to " + std::to_string(vertices_.size()));
    }
    return static_cast<uint32_t>(place - 1.0);
  }

  void read_face() {
    if (words_.size() < 4 || words_.size() > most_corners + 1) {
      throw wrong("f", std::to_string(words_.size() - 1) + " corners",
                  "3 to " + std::to_string(most_corners));
    }
    std::vector<uint32_t> of;
    std::vector<Vec3> corners;
    for (size_t i = 1; i < words_.size(); ++i) {
      of.push_back(vertex_of(words_[i]));
      corners.push_back(vertices_[of.back()]);
    }
    if (crosses_itself(corners)) {
      throw wrong("f", "a face whose edges cross each other",
                  "corners in order round the face (or two faces)");
    }
    if (part_ == nullptr) begin_part();
    for (const auto& [a, b, c] : triangles_of(corners)) {
      if (++triangles_ > most_triangles) {
        throw wrong("f", "more triangles", "at most " + std::to_string(most_triangles));
      }
      part_->mesh.triangles.push_back({used(of[a]), used(of[b]), used(of[c])});
    }
  }

  // All faces of one object, group and material are one part, also if they are not consecutive.
  void begin_part() {
    std::string name = object_;
    if (!group_.empty() && group_ != object_) name += (name.empty() ? "" : "/") + group_;
    if (name.empty()) name = name_;
    const std::string key = name + '\n' + material_;
    const auto [entry, is_new] =
        parts_.try_emplace(key, Part{name, material_.empty() ? name_ : material_, {}});
    if (is_new) order_.push_back(key);
    part_ = &entry->second;
    places_ = &places_of_[key];
  }

  // Index of a vertex of the file in the part's mesh.
  uint32_t used(uint32_t vertex) {
    const auto [entry, is_new] =
        places_->try_emplace(vertex, static_cast<uint32_t>(part_->mesh.vertices_m.size()));
    if (is_new) part_->mesh.vertices_m.push_back(vertices_[vertex]);
    return entry->second;
  }

  DataLines lines_;
  std::string name_, object_, group_, material_, joined_;
  InputLocation where_;
  std::vector<std::string_view> words_;
  std::vector<Vec3> vertices_;
  std::map<std::string, Part> parts_;
  std::map<std::string, std::unordered_map<uint32_t, uint32_t>> places_of_;
  std::vector<std::string> order_;
  Part* part_ = nullptr;
  std::unordered_map<uint32_t, uint32_t>* places_ = nullptr;
  size_t triangles_ = 0;
};

}  // namespace

std::vector<Part> read_obj(std::string_view text, const std::string& file,
                           const std::string& name) {
  return ObjReader(text, file, name).read();
}

}  // namespace photorque::cad
