// EXT_meshopt_compression: buffer views compressed with meshoptimizer. Source: KhronosGroup/glTF,
// extensions/2.0/Vendor/EXT_meshopt_compression.
#include <meshoptimizer.h>

#include "scenes/gltf/file/document.h"

namespace photorque::gltf {
namespace {

using nlohmann::json;

constexpr const char* meshopt_extension = "EXT_meshopt_compression";

struct Packed {
  uint64_t count = 0, stride = 0;
  std::string mode, filter;
  std::string_view data;
};

// Checks conditions that the decoders assume.
void require_possible(const Document& document, const Packed& packed, const std::string& where) {
  const auto fail = [&](const char* key, const std::string& found, const char* expected) {
    throw document.wrong(where + pointer(key), found, expected);
  };
  const std::string stride = std::to_string(packed.stride);
  constexpr uint64_t largest_stride = 256;
  if (packed.mode == "ATTRIBUTES") {
    if (packed.stride == 0 || packed.stride % 4 != 0 || packed.stride > largest_stride) {
      fail("byteStride", stride, "a multiple of 4 up to 256");
    }
  } else if (packed.mode == "TRIANGLES" || packed.mode == "INDICES") {
    if (packed.stride != 2 && packed.stride != 4) fail("byteStride", stride, "2 or 4");
    if (packed.mode == "TRIANGLES" && packed.count % 3 != 0) {
      fail("count", std::to_string(packed.count), "a multiple of 3");
    }
    if (packed.filter != "NONE") fail("filter", packed.filter, "none for indices");
  } else {
    fail("mode", "\"" + packed.mode + "\"", "ATTRIBUTES, TRIANGLES or INDICES");
  }
  const bool octahedral = packed.filter == "OCTAHEDRAL", quaternion = packed.filter == "QUATERNION";
  if (octahedral && packed.stride != 4 && packed.stride != 8) fail("byteStride", stride, "4 or 8");
  if (quaternion && packed.stride != 8) fail("byteStride", stride, "8");
  if (!octahedral && !quaternion && packed.filter != "EXPONENTIAL" && packed.filter != "NONE") {
    fail("filter", "\"" + packed.filter + "\"", "NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL");
  }
}

Packed read_packed(const Document& document, const json& extension, const std::string& where) {
  const auto number = [&](const char* key) {
    return extension_number(document, extension, key, where);
  };
  const auto text = [&](const char* key, const char* otherwise) {
    const auto found = extension.find(key);
    if (found == extension.end()) return std::string(otherwise);
    return found->is_string() ? found->get<std::string>() : describe_json(*found);
  };
  Packed packed{
      number("count"), number("byteStride"), text("mode", ""), text("filter", "NONE"), {}};
  require_possible(document, packed, where);
  const uint64_t offset = extension.contains("byteOffset") ? number("byteOffset") : 0;
  packed.data = buffer_bytes(document, number("buffer"), offset, number("byteLength"), where);
  return packed;
}

// A view repeats its length and stride for readers without the extension; both must match the
// extension's.
void require_equal_extents(const Document& document, const json& view, const Packed& packed,
                           size_t index) {
  const auto compare = [&](const char* key, uint64_t decoded) {
    const auto stated = view.find(key);
    if (stated == view.end() || *stated == decoded) return;
    throw document.wrong(pointer("bufferViews", index, key), describe_json(*stated),
                         std::to_string(decoded) + ", by what is packed in it");
  };
  compare("byteLength", packed.count * packed.stride);
  compare("byteStride", packed.stride);
}

std::string unpacked(const Document& document, const Packed& packed, MemoryBudget* budget,
                     const std::string& where) {
  if (packed.count == 0) throw document.wrong(where + "/count", "0", "at least 1");
  budget->charge(packed.count, packed.stride, where);
  std::string bytes(packed.count * packed.stride, '\0');
  const auto* const from = reinterpret_cast<const unsigned char*>(packed.data.data());
  const size_t size = packed.data.size();
  int failure = 0;
  if (packed.mode == "ATTRIBUTES") {
    failure = meshopt_decodeVertexBuffer(bytes.data(), packed.count, packed.stride, from, size);
  } else if (packed.mode == "TRIANGLES") {
    failure = meshopt_decodeIndexBuffer(bytes.data(), packed.count, packed.stride, from, size);
  } else {
    failure = meshopt_decodeIndexSequence(bytes.data(), packed.count, packed.stride, from, size);
  }
  if (failure != 0) {
    throw document.wrong(where, "data that cannot be decoded", "a stream of meshoptimizer");
  }
  if (packed.filter == "OCTAHEDRAL") {
    meshopt_decodeFilterOct(bytes.data(), packed.count, packed.stride);
  } else if (packed.filter == "QUATERNION") {
    meshopt_decodeFilterQuat(bytes.data(), packed.count, packed.stride);
  } else if (packed.filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(bytes.data(), packed.count, packed.stride);
  }
  return bytes;
}

}  // namespace

void decode_meshopt_views(Document* document, MemoryBudget* budget) {
  if (!document->json.contains("bufferViews")) return;
  const size_t views = document->json["bufferViews"].size();
  for (size_t i = 0; i < views; ++i) {
    json& view = document->json["bufferViews"][i];
    const json* const found = extension_of(view, meshopt_extension);
    if (!found) continue;
    const json extension = *found;
    const std::string where = pointer("bufferViews", i, "extensions", meshopt_extension);
    const Packed packed = read_packed(*document, extension, where);
    std::string bytes = unpacked(*document, packed, budget, where);
    require_equal_extents(*document, view, packed, i);
    view["byteLength"] = bytes.size();
    view["byteOffset"] = 0;
    view["buffer"] = add_buffer(document, std::move(bytes));
    view.erase("extensions");
  }
}

}  // namespace photorque::gltf
