#include "images/browser/baked.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/errors.h"
#include "images/drawing/colour_map.h"
#include "images/writers/image_file.h"

namespace photorque {
namespace {

using Json = nlohmann::ordered_json;
using Point = std::array<float, 3>;

static_assert(std::endian::native == std::endian::little, "GLB is little-endian");

constexpr size_t most_triangles = 400000;  // of scene 1
constexpr int array_buffer = 34962, index_buffer = 34963;

Point turned(const float* body) {
  return {body[0], body[2], -body[1]};
}

// The binary chunk with its views and accessors.
class Buffer {
 public:
  int add_view(const void* data, size_t bytes, std::optional<int> target = {}) {
    Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes}};
    if (target) view["target"] = *target;
    bytes_.append(static_cast<const char*>(data), bytes);
    bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
    views.push_back(std::move(view));
    return static_cast<int>(views.size()) - 1;
  }
  template <size_t N>
  int add(const std::vector<std::array<float, N>>& rows) {
    std::array<float, N> low, high;
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    for (const auto& row : rows) {
      for (size_t k = 0; k < N; ++k) {
        low[k] = std::min(low[k], row[k]);
        high[k] = std::max(high[k], row[k]);
      }
    }
    const int view = add_view(rows.data(), rows.size() * sizeof rows[0], array_buffer);
    constexpr const char* types[] = {"", "SCALAR", "VEC2", "VEC3"};
    accessors.push_back({{"bufferView", view},
                         {"componentType", 5126},
                         {"count", rows.size()},
                         {"type", types[N]},
                         {"min", low},
                         {"max", high}});
    return static_cast<int>(accessors.size()) - 1;
  }
  int add(const std::vector<uint32_t>& indices) {
    const int view = add_view(indices.data(), indices.size() * sizeof(uint32_t), index_buffer);
    accessors.push_back({{"bufferView", view},
                         {"componentType", 5125},
                         {"count", indices.size()},
                         {"type", "SCALAR"}});
    return static_cast<int>(accessors.size()) - 1;
  }
  const std::string& bytes() const { return bytes_; }

  Json views = Json::array(), accessors = Json::array();

 private:
  std::string bytes_;
};

// The map's value between the middles of its bins, at (u, v) in [0, 1]².
double value_at(const Map& map, double u, double v) {
  const auto place = [](double fraction, int bins) {
    return std::clamp(fraction * bins - 0.5, 0.0, bins - 1.0);
  };
  const double x = place(u, map.width), y = place(v, map.height);
  const int column = std::min(static_cast<int>(x), std::max(map.width - 2, 0));
  const int row = std::min(static_cast<int>(y), std::max(map.height - 2, 0));
  double sum = 0.0, weights = 0.0;
  for (const int j : {row, std::min(row + 1, map.height - 1)}) {
    for (const int i : {column, std::min(column + 1, map.width - 1)}) {
      const double weight =
          std::max(0.0, 1.0 - std::abs(x - i)) * std::max(0.0, 1.0 - std::abs(y - j));
      const double value = map.value[static_cast<size_t>(j) * map.width + i];
      if (!std::isfinite(value) || weight == 0.0) continue;  // bins beside the surface
      sum += weight * value;
      weights += weight;
    }
  }
  return weights > 0.0 ? sum / weights : std::numeric_limits<double>::quiet_NaN();
}

constexpr Rgb unlit_grey = {0.5, 0.5, 0.5};

Rgb colour_of(const ColourScale& scale, double value) {
  return std::isfinite(value) ? scale(value) : unlit_grey;
}

class Model {
 public:
  Model(const SceneStage& stage, const Product& product, const Provenance& provenance)
      : stage_(stage), product_(product), provenance_(provenance) {}

  std::string glb() {
    const Painting painting = stage_.paintings.empty() ? Painting{} : stage_.paintings.front();
    scale_ = scale_of(painting);
    note_covered(painting);
    std::vector<int> parts, textured, coloured;
    for (const StagePart& part : stage_.parts) add_part(part, parts);
    // However many bins: no more triangles than are drawn with ease.
    size_t bins = 0;
    for (const PaintedSurface& surface : painting.surfaces) bins += bins_of(surface);
    const double coarser = std::sqrt(
        std::max(1.0, 2.0 * static_cast<double>(bins) / static_cast<double>(most_triangles)));
    for (const PaintedSurface& surface : painting.surfaces) {
      add_textured(surface, textured);
      add_coloured(surface, coarser, coloured);
      add_back(surface, parts);
    }
    const int body = add_root("body", parts);
    // Nodes in two scenes are legal, but viewers take them out of the first: a copy on the same
    // meshes.
    for (int& node : parts) {
      nodes_.push_back(nodes_[static_cast<size_t>(node)]);
      node = static_cast<int>(nodes_.size()) - 1;
    }
    const int body_again = add_root("body", parts);
    const int textures = add_root("light as textures", textured);
    const int colours = add_root("light as vertex colours", coloured);
    Json scenes = {{{"name", "textures"}, {"nodes", {body, textures}}},
                   {{"name", "vertex colours"}, {"nodes", {body_again, colours}}}};
    return packed(painting, std::move(scenes));
  }

 private:
  const Map& map_of(const PaintedSurface& surface) const {
    for (const Map& map : product_.maps) {
      if (map.name == surface.map) return map;
    }
    throw InputError({surface.name}, surface.map, "no such map", "a map of the run");
  }
  size_t bins_of(const PaintedSurface& surface) const { return map_of(surface).value.size(); }

  ColourScale scale_of(const Painting& painting) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const PaintedSurface& surface : painting.surfaces) {
      for (const double value : map_of(surface).value) {
        if (!std::isfinite(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
    return low <= high ? colour_scale(low, high, painting.signed_values)
                       : ColourScale{0, 1, viridis()};
  }

  // Triangles under the painting, by their corners: the parts leave them out.
  using Corners = std::array<Point, 3>;
  static Corners corners_of(const std::vector<float>& position_m, const uint32_t* triangle) {
    Corners corners;
    for (size_t k = 0; k < 3; ++k) corners[k] = turned(&position_m[3 * triangle[k]]);
    std::sort(corners.begin(), corners.end());
    return corners;
  }
  void note_covered(const Painting& painting) {
    for (const PaintedSurface& surface : painting.surfaces) {
      for (size_t t = 0; t + 2 < surface.triangles.size(); t += 3) {
        covered_.insert(corners_of(surface.position_m, &surface.triangles[t]));
      }
    }
  }

  int add_material(const std::string& name, const Rgb& colour, bool both_sides,
                   std::optional<int> texture = {}) {
    Json look = {{"metallicFactor", 0}, {"roughnessFactor", 1}};
    look["baseColorFactor"] = {linear_from_encoded(colour.red), linear_from_encoded(colour.green),
                               linear_from_encoded(colour.blue), 1};
    if (texture) look["baseColorTexture"] = {{"index", *texture}};
    Json material = {{"name", name}, {"pbrMetallicRoughness", look}, {"doubleSided", both_sides}};
    if (name != "part") material["extensions"] = {{"KHR_materials_unlit", Json::object()}};
    materials_.push_back(std::move(material));
    return static_cast<int>(materials_.size()) - 1;
  }

  void add_node(const std::string& name, Json attributes, int indices, int material,
                std::vector<int>& nodes) {
    Json primitive = {
        {"attributes", std::move(attributes)}, {"indices", indices}, {"material", material}};
    meshes_.push_back({{"name", name}, {"primitives", {std::move(primitive)}}});
    nodes_.push_back({{"name", name}, {"mesh", meshes_.size() - 1}});
    nodes.push_back(static_cast<int>(nodes_.size()) - 1);
  }

  int add_root(const std::string& name, const std::vector<int>& children) {
    Json node = {{"name", name}};
    const Quat q = stage_.states.empty() || stage_.states[0].lab_from_body.empty()
                       ? Quat::Identity()
                       : stage_.states[0].lab_from_body[0];
    node["rotation"] = {q.x(), q.z(), -q.y(), q.w()};
    if (!children.empty()) node["children"] = children;
    nodes_.push_back(std::move(node));
    return static_cast<int>(nodes_.size()) - 1;
  }

  static std::vector<Point> points_of(const std::vector<float>& position_m) {
    std::vector<Point> points;
    for (size_t i = 0; i + 2 < position_m.size(); i += 3) points.push_back(turned(&position_m[i]));
    return points;
  }

  void add_part(const StagePart& part, std::vector<int>& nodes) {
    std::vector<uint32_t> seen;
    for (size_t t = 0; t + 2 < part.triangles.size(); t += 3) {
      if (covered_.contains(corners_of(part.position_m, &part.triangles[t]))) continue;
      seen.insert(seen.end(), &part.triangles[t], &part.triangles[t] + 3);
    }
    if (seen.empty()) return;
    add_node(part.name, {{"POSITION", buffer_.add(points_of(part.position_m))}}, buffer_.add(seen),
             add_material("part", part.colour, true), nodes);
  }

  // The triangles as the painted side shows them, and as the other one does.
  static std::vector<uint32_t> painted_side(const PaintedSurface& surface, bool painted) {
    std::vector<uint32_t> triangles = surface.triangles;
    if ((surface.side == PaintedSurface::Side::back) == painted) {
      for (size_t t = 0; t + 2 < triangles.size(); t += 3)
        std::swap(triangles[t + 1], triangles[t + 2]);
    }
    return triangles;
  }
  static bool both_sides(const PaintedSurface& surface) {
    return surface.side == PaintedSurface::Side::both;
  }

  void add_textured(const PaintedSurface& surface, std::vector<int>& nodes) {
    const Map& map = map_of(surface);
    Picture picture{map.width, map.height, {}};
    for (int row = map.height - 1; row >= 0; --row) {  // the picture begins at the top
      for (int column = 0; column < map.width; ++column) {
        const double value = map.value[static_cast<size_t>(row) * map.width + column];
        for (const uint8_t byte : rgb_bytes(colour_of(scale_, value))) picture.rgb.push_back(byte);
      }
    }
    const std::string png =
        png_bytes(picture, {provenance_.one_line(), map.title, provenance_.program});
    images_.push_back({{"name", map.name},
                       {"bufferView", buffer_.add_view(png.data(), png.size())},
                       {"mimeType", "image/png"}});
    textures_.push_back({{"sampler", 0}, {"source", images_.size() - 1}});
    std::vector<std::array<float, 2>> uv;
    for (size_t i = 0; i + 1 < surface.uv.size(); i += 2) {
      uv.push_back({surface.uv[i], 1.0f - surface.uv[i + 1]});  // glTF counts v from the top
    }
    const int position = buffer_.add(points_of(surface.position_m)), texture_at = buffer_.add(uv);
    add_node(surface.name, {{"POSITION", position}, {"TEXCOORD_0", texture_at}},
             buffer_.add(painted_side(surface, true)),
             add_material(surface.name, {1, 1, 1}, both_sides(surface),
                          static_cast<int>(textures_.size()) - 1),
             nodes);
  }

  void add_coloured(const PaintedSurface& surface, double coarser, std::vector<int>& nodes) {
    const Map& map = map_of(surface);
    std::vector<Point> position, colour;
    std::vector<std::array<float, 1>> shown;
    std::vector<uint32_t> triangles;
    const std::vector<uint32_t> sided = painted_side(surface, true);
    for (size_t t = 0; t + 2 < sided.size(); t += 3) {
      std::array<Point, 3> corner;
      std::array<std::array<double, 2>, 3> uv;
      double longest = 0.0;  // in bins
      for (size_t k = 0; k < 3; ++k) {
        corner[k] = turned(&surface.position_m[3 * sided[t + k]]);
        uv[k] = {surface.uv[2 * sided[t + k]], surface.uv[2 * sided[t + k] + 1]};
      }
      for (size_t k = 0; k < 3; ++k) {
        const auto &a = uv[k], &b = uv[(k + 1) % 3];
        longest = std::max(
            {longest, std::abs(a[0] - b[0]) * map.width, std::abs(a[1] - b[1]) * map.height});
      }
      const auto n =
          static_cast<uint32_t>(std::clamp(std::ceil(longest / coarser - 1e-6), 1.0, 400.0));
      const auto first = static_cast<uint32_t>(position.size());
      for (uint32_t i = 0; i <= n; ++i) {
        for (uint32_t j = 0; j <= n - i; ++j) {
          const double b = static_cast<double>(i) / n, c = static_cast<double>(j) / n,
                       a = 1 - b - c;
          Point at;
          for (size_t k = 0; k < 3; ++k) {
            at[k] = static_cast<float>(a * corner[0][k] + b * corner[1][k] + c * corner[2][k]);
          }
          const double value = value_at(map, a * uv[0][0] + b * uv[1][0] + c * uv[2][0],
                                        a * uv[0][1] + b * uv[1][1] + c * uv[2][1]);
          const Rgb rgb = colour_of(scale_, value);
          position.push_back(at);
          colour.push_back({static_cast<float>(linear_from_encoded(rgb.red)),
                            static_cast<float>(linear_from_encoded(rgb.green)),
                            static_cast<float>(linear_from_encoded(rgb.blue))});
          shown.push_back({std::isfinite(value) ? static_cast<float>(value) : 0.0f});
        }
      }
      const auto at = [&](uint32_t i, uint32_t j) {
        return first + i * (n + 1) - i * (i - 1) / 2 + j;
      };
      for (uint32_t i = 0; i < n; ++i) {
        for (uint32_t j = 0; j < n - i; ++j) {
          triangles.insert(triangles.end(), {at(i, j), at(i + 1, j), at(i, j + 1)});
          if (j + 1 < n - i)
            triangles.insert(triangles.end(), {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
      }
    }
    Json attributes = {{"POSITION", buffer_.add(position)}};
    attributes["COLOR_0"] = buffer_.add(colour);
    attributes["_VALUE"] = buffer_.add(shown);
    add_node(surface.name, std::move(attributes), buffer_.add(triangles),
             add_material(surface.name, {1, 1, 1}, both_sides(surface)), nodes);
  }

  // What a surface that is painted on one side shows on the other.
  void add_back(const PaintedSurface& surface, std::vector<int>& nodes) {
    if (both_sides(surface)) return;
    add_node(
        surface.name + ", other side", {{"POSITION", buffer_.add(points_of(surface.position_m))}},
        buffer_.add(painted_side(surface, false)), add_material("part", unlit_grey, false), nodes);
  }

  std::string packed(const Painting& painting, Json scenes) {
    Json about = {{"provenance", provenance_.one_line()},
                  {"painted", painting.title},
                  {"unit", painting.unit},
                  {"colour_map", painting.signed_values ? "cool to warm (Moreland)" : "viridis"},
                  {"low", scale_.low},
                  {"high", scale_.high}};
    Json file = {{"asset",
                  {{"version", "2.0"},
                   {"generator", provenance_.program + " " + provenance_.version},
                   {"extras", {{"photorque", std::move(about)}}}}}};
    file["extensionsUsed"] = {"KHR_materials_unlit"};
    file["scene"] = 0;
    file["scenes"] = std::move(scenes);
    file["nodes"] = nodes_;
    const auto add = [&](const char* name, const Json& all) {
      if (!all.empty()) file[name] = all;  // glTF has no empty lists
    };
    add("meshes", meshes_);
    add("materials", materials_);
    add("textures", textures_);
    add("images", images_);
    if (!textures_.empty()) {
      file["samplers"] = {
          {{"magFilter", 9728}, {"minFilter", 9729}, {"wrapS", 33071}, {"wrapT", 33071}}};
    }
    add("accessors", buffer_.accessors);
    add("bufferViews", buffer_.views);
    if (!buffer_.bytes().empty()) file["buffers"] = {{{"byteLength", buffer_.bytes().size()}}};
    std::string text = file.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string glb;
    const auto word = [&glb](size_t number) {
      const auto bits = static_cast<uint32_t>(number);
      glb.append(reinterpret_cast<const char*>(&bits), sizeof bits);
    };
    const size_t binary = buffer_.bytes().empty() ? 0 : 8 + buffer_.bytes().size();
    word(0x46546C67), word(2), word(20 + text.size() + binary);
    word(text.size()), word(0x4E4F534A);
    glb += text;
    if (binary > 0) {
      word(buffer_.bytes().size()), word(0x004E4942);
      glb += buffer_.bytes();
    }
    return glb;
  }

  const SceneStage& stage_;
  const Product& product_;
  const Provenance& provenance_;
  ColourScale scale_;
  std::set<Corners> covered_;
  Buffer buffer_;
  Json nodes_ = Json::array(), meshes_ = Json::array(), materials_ = Json::array();
  Json textures_ = Json::array(), images_ = Json::array();
};

}  // namespace

std::string baked_glb(const SceneStage& stage, const Product& product,
                      const Provenance& provenance) {
  return Model(stage, product, provenance).glb();
}

}  // namespace photorque
