#include "scenes/gltf/texture.h"

#include <cmath>
#include <map>

#include "scenes/gltf/file/fault.h"
#include "scenes/gltf/optics.h"

namespace photorque::gltf {
namespace {

using nlohmann::json;
using Colour = std::array<double, 3>;

constexpr int luminance_steps = 32;

// Colour of the texel at texture coordinates.
Colour texel(const BaseColours& picture, const Vec2& uv) {
  const auto place = [](double coordinate, int size) {
    const double part = coordinate - std::floor(coordinate);
    return std::min(static_cast<int>(part * size), size - 1);
  };
  const auto at =
      3 * (static_cast<size_t>(place(uv.y(), picture.height)) * static_cast<size_t>(picture.width) +
           static_cast<size_t>(place(uv.x(), picture.width)));
  return {picture.rgb[at], picture.rgb[at + 1], picture.rgb[at + 2]};
}

Colour mean_over(const BaseColours& picture, const std::array<Vec2, 3>& uv) {
  const Vec2 size(picture.width, picture.height);
  const double longest = std::max({(uv[1] - uv[0]).cwiseProduct(size).norm(),
                                   (uv[2] - uv[0]).cwiseProduct(size).norm(),
                                   (uv[2] - uv[1]).cwiseProduct(size).norm()});
  const int across = static_cast<int>(std::clamp(std::ceil(longest), 2.0, 64.0));
  Colour sum{};
  int points = 0;
  for (int i = 0; i < across; ++i) {
    for (int j = 0; i + j < across; ++j, ++points) {
      const double b = (i + 1.0 / 3.0) / across, c = (j + 1.0 / 3.0) / across;
      const Colour colour = texel(picture, uv[0] + b * (uv[1] - uv[0]) + c * (uv[2] - uv[0]));
      for (size_t k = 0; k < 3; ++k) sum[k] += colour[k];
    }
  }
  for (double& value : sum) value /= points;
  return sum;
}

double area_of(const Mesh& mesh, const std::array<uint32_t, 3>& triangle) {
  const Vec3& a = mesh.vertices_m[triangle[0]];
  return 0.5 * (mesh.vertices_m[triangle[1]] - a).cross(mesh.vertices_m[triangle[2]] - a).norm();
}

// A mesh of these triangles with the vertices that they use.
Mesh part_of(const Mesh& mesh, const std::vector<size_t>& triangles) {
  Mesh part;
  std::map<uint32_t, uint32_t> moved;
  for (const size_t t : triangles) {
    std::array<uint32_t, 3> corners{};
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t from = mesh.triangles[t][k];
      const auto [place, is_new] =
          moved.emplace(from, static_cast<uint32_t>(part.vertices_m.size()));
      if (is_new) {
        part.vertices_m.push_back(mesh.vertices_m[from]);
        part.uv.push_back(mesh.uv[from]);
      }
      corners[k] = place->second;
    }
    part.triangles.push_back(corners);
  }
  return part;
}

}  // namespace

std::optional<BaseColours> base_colour_picture(const Document& document, int material,
                                               const GltfOpen& open, const PictureReader& read,
                                               MemoryBudget* budget) {
  if (material < 0) return std::nullopt;
  const std::string where =
      pointer("materials", material, "pbrMetallicRoughness", "baseColorTexture");
  const json::json_pointer place(where);
  if (!document.json.contains(place)) return std::nullopt;
  const json& info = document.json[place];
  if (!info.is_object()) return std::nullopt;
  // Only the first set of texture coordinates is supported.
  json coordinates = info.value("texCoord", json(0));
  const json::json_pointer other("/extensions/KHR_texture_transform/texCoord");
  if (info.contains(other)) coordinates = info[other];
  if (coordinates != 0) return std::nullopt;
  const json& texture =
      element_of(document, where + "/index", info.value("index", json()), "textures");
  const json index = texture.value("source", json());
  const json& image = element_of(document, where, index, "images");
  const std::string named = pointer("images", index.get<size_t>());
  const std::string bytes =
      image.contains("bufferView")
          ? std::string(bytes_of_view(document, named + "/bufferView", image["bufferView"]))
          : load_uri({image, named, {"image/png", "image/jpeg"}}, document.file, open, budget);
  try {
    BaseColours picture = read(bytes);
    budget->charge(picture.rgb.size(), sizeof(float), named);
    return picture;
  } catch (const InputError& error) {
    throw InputError({document.file}, named + ": " + error.what(), "", "");
  }
}

std::vector<TextureStep> texture_steps(const Mesh& mesh, const BaseColours& picture) {
  std::map<int, std::pair<std::vector<size_t>, std::vector<Colour>>> steps;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corners = mesh.triangles[t];
    const Colour colour =
        mean_over(picture, {mesh.uv[corners[0]], mesh.uv[corners[1]], mesh.uv[corners[2]]});
    auto& [triangles, colours] = steps[static_cast<int>(luminance(colour) * luminance_steps)];
    triangles.push_back(t);
    colours.push_back(colour);
  }
  std::vector<TextureStep> parts;
  for (const auto& [step, members] : steps) {
    const auto& [triangles, colours] = members;
    TextureStep part{part_of(mesh, triangles), {}};
    double area = 0.0;
    for (size_t i = 0; i < triangles.size(); ++i) {
      const double weight = area_of(mesh, mesh.triangles[triangles[i]]);
      for (size_t k = 0; k < 3; ++k) part.colour[k] += weight * colours[i][k];
      area += weight;
    }
    for (double& value : part.colour) value /= area;
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace photorque::gltf
