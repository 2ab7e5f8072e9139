#include "scenes/gltf/file/document.h"

#include <algorithm>

#include "core/little_endian.h"
#include "core/text/parse.h"

namespace photorque::gltf {

namespace {

// Outermost layer of a glTF file: plain JSON text, or the chunks of a binary file (.glb). The views
// refer to the bytes of the file.
struct Container {
  std::string_view json;
  std::optional<std::string_view> binary;  // the BIN chunk
  bool is_binary = false;
  std::vector<std::string> notices;
};

// glTF 2.0, section 4.4.
constexpr uint32_t magic = 0x46546C67;       // "glTF"
constexpr uint32_t json_chunk = 0x4E4F534A;  // "JSON"
constexpr uint32_t bin_chunk = 0x004E4942;   // "BIN\0"
constexpr size_t header_bytes = 12;
constexpr size_t chunk_header_bytes = 8;

std::string bytes_text(uint64_t count) {
  return std::to_string(count) + " bytes";
}

struct Chunk {
  uint32_t type = 0;
  std::string_view data;
};

// Bytes from the header to the declared end.
std::string_view checked_body(std::string_view bytes, const std::string& file,
                              std::vector<std::string>* notices) {
  const auto wrong = [&](const std::string& found, const std::string& expected) {
    return InputError({file}, "GLB header", found, expected);
  };
  if (bytes.size() < header_bytes) throw wrong(bytes_text(bytes.size()), "at least 12 bytes");
  if (little_endian_32(bytes, 0) != magic)
    throw wrong("no magic word", "a file that begins with \"glTF\"");
  if (little_endian_32(bytes, 4) != 2)
    throw wrong("version " + std::to_string(little_endian_32(bytes, 4)), "version 2");
  const size_t length = little_endian_32(bytes, 8);
  if (length < header_bytes + chunk_header_bytes || length > bytes.size()) {
    throw wrong("a length of " + bytes_text(length) + " in a file of " + bytes_text(bytes.size()),
                "the length of the file");
  }
  if (length < bytes.size()) {
    notices->push_back(bytes_text(bytes.size() - length) + " after the end of the GLB are ignored");
  }
  return bytes.substr(header_bytes, length - header_bytes);
}

std::vector<Chunk> split(std::string_view body, const std::string& file) {
  std::vector<Chunk> chunks;
  while (!body.empty()) {
    const std::string where = "GLB chunk " + std::to_string(chunks.size());
    if (body.size() < chunk_header_bytes) {
      throw InputError({file}, where, bytes_text(body.size()), "a chunk header of 8 bytes");
    }
    const size_t length = little_endian_32(body, 0);
    if (length > body.size() - chunk_header_bytes) {
      throw InputError({file}, where, bytes_text(body.size() - chunk_header_bytes),
                       bytes_text(length) + " as its header says");
    }
    if (length % 4 != 0) {
      throw InputError({file}, where, "a length of " + bytes_text(length), "a multiple of 4");
    }
    chunks.push_back({little_endian_32(body, 4), body.substr(chunk_header_bytes, length)});
    body.remove_prefix(chunk_header_bytes + length);
  }
  return chunks;
}

// Splits a file into JSON and binary chunk. It is binary if it begins with the magic "glTF" or if
// `file` ends in ".glb". Throws InputError for all violations of chapter 4 of the specification:
// wrong magic or version, a length beyond the file, truncated, unaligned, missing, misplaced or
// repeated chunks. Bytes after the declared length and chunks of unknown type are ignored with a
// notice.
Container open_container(std::string_view bytes, const std::string& file) {
  Container container;
  container.is_binary = bytes.starts_with("glTF") || file.ends_with(".glb");
  if (!container.is_binary) {
    container.json = bytes;
    return container;
  }
  const std::vector<Chunk> chunks = split(checked_body(bytes, file, &container.notices), file);
  if (chunks[0].type != json_chunk || chunks[0].data.empty()) {
    throw InputError({file}, "GLB chunk 0",
                     chunks[0].data.empty() ? "an empty chunk" : "a chunk of another type",
                     "JSON text");
  }
  container.json = chunks[0].data;
  for (size_t i = 1; i < chunks.size(); ++i) {
    const std::string where = "GLB chunk " + std::to_string(i);
    if (chunks[i].type == json_chunk || (chunks[i].type == bin_chunk && container.binary)) {
      throw InputError({file}, where, "a second chunk of its type", "at most one JSON and one BIN");
    }
    if (chunks[i].type != bin_chunk) {
      container.notices.push_back(where + " is of unknown type and ignored");
      continue;
    }
    if (i != 1) throw InputError({file}, where, "the BIN chunk", "it right after the JSON chunk");
    container.binary = chunks[i].data;
  }
  return container;
}

using nlohmann::json;

// glTF needs no deeper nesting, and readers recurse once per level.
constexpr int deepest_nesting = 64;

// Extensions that do not affect triangles and transforms, or that are implemented. Names that end
// in an underscore are prefixes.
constexpr std::array harmless_extensions = {"KHR_materials_",
                                            "KHR_texture_",
                                            "EXT_texture_",
                                            "MSFT_texture_",
                                            "KHR_lights_",
                                            "EXT_lights_",
                                            "KHR_xmp",
                                            "KHR_xmp_",
                                            "KHR_animation_pointer",
                                            "KHR_draco_mesh_compression",
                                            "KHR_mesh_quantization",
                                            "EXT_meshopt_compression",
                                            "EXT_mesh_manifold",
                                            "EXT_mesh_gpu_instancing",
                                            "AGI_articulations",
                                            "AGI_stk_metadata",
                                            "CESIUM_primitive_outline"};

bool is_harmless(std::string_view extension) {
  return std::any_of(
      harmless_extensions.begin(), harmless_extensions.end(), [&](std::string_view known) {
        return known.ends_with('_') ? extension.starts_with(known) : extension == known;
      });
}

// Rejects documents of excessive cost before they are parsed: deep nesting, or more values than the
// memory budget allows.
void check_extent(std::string_view text, const std::string& file, MemoryBudget* budget) {
  constexpr uint64_t bytes_per_value = 256;
  const JsonExtent extent = extent_of_json(text);
  if (extent.depth > deepest_nesting) {
    throw InputError({file}, "", "JSON nested deeper than " + std::to_string(deepest_nesting),
                     "a glTF document");
  }
  budget->charge(text.size(), 2, "");
  budget->charge(extent.values, bytes_per_value, "");
}

// Short reason of a JSON error, without the position, which the caller adds:
// "[json.exception.parse_error.101] parse error at line 1, column 2: unexpected end" → "unexpected
// end".
std::string reason(const json::exception& error) {
  const std::string text = error.what();
  const size_t place = text.find("column ");
  const size_t colon = place == std::string::npos ? std::string::npos : text.find(": ", place);
  if (colon != std::string::npos) return text.substr(colon + 2);
  const size_t bracket = text.find("] ");
  return bracket == std::string::npos ? text : text.substr(bracket + 2);
}

json parse_text(std::string_view text, const std::string& file, MemoryBudget* budget) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) {
    throw InputError({file, 1}, "", "a byte order mark", "JSON text in UTF-8 without one");
  }
  check_extent(text, file, budget);
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    const auto newlines =
        std::count(text.begin(), text.begin() + std::min(error.byte, text.size()), '\n');
    throw InputError({file, static_cast<int>(newlines) + 1}, "", reason(error), "JSON text");
  } catch (const json::out_of_range& error) {
    throw InputError({file}, "", reason(error), "numbers within double precision");
  }
}

void check_version(const Document& document) {
  const json& asset = document.json["asset"];
  for (const char* key : {"version", "minVersion"}) {
    const std::string version = asset.value(key, "2.0");
    const bool known = key == std::string("version") ? version.starts_with("2.") : version == "2.0";
    if (!known) throw document.wrong(pointer("asset", key), "\"" + version + "\"", "\"2.0\"");
  }
}

void check_required_extensions(const Document& document) {
  const auto required = document.json.find("extensionsRequired");
  if (required == document.json.end()) return;
  if (!required->is_array()) {
    throw document.wrong("/extensionsRequired", describe_json(*required), "an array of texts");
  }
  for (size_t i = 0; i < required->size(); ++i) {
    const json& extension = (*required)[i];
    if (!extension.is_string() || !is_harmless(extension.get_ref<const std::string&>())) {
      throw document.wrong(pointer("extensionsRequired", i), describe_json(extension),
                           "extensions that this program supports");
    }
  }
}

// Removes extras and extensions, which are read from the JSON: tinygltf would need a hundred times
// their size in memory.
void strip_extras(json* value) {
  if (value->is_object()) {
    value->erase("extras");
    value->erase("extensions");
  }
  if (!value->is_structured()) return;
  for (json& item : *value) strip_extras(&item);
}

// The document for tinygltf. It lacks the sections that tracing does not need, so that errors in
// them have no effect; buffers, whose bytes are already loaded; and the indices of primitives,
// whose bufferView tinygltf would access.
json geometry_of(const json& document) {
  json geometry = json::object();
  for (const char* key :
       {"asset", "bufferViews", "accessors", "materials", "meshes", "nodes", "scenes", "scene"}) {
    const auto section = document.find(key);
    if (section != document.end()) geometry[key] = *section;
  }
  strip_extras(&geometry);
  if (geometry.contains("meshes")) {
    for (json& mesh : geometry["meshes"]) {
      for (json& primitive : mesh["primitives"]) primitive.erase("indices");
    }
  }
  return geometry;
}

tinygltf::Model typed_model(const Document& document) {
  const std::string text = geometry_of(document.json).dump();
  tinygltf::Model model;
  std::string error, warning;
  if (!tinygltf::TinyGLTF().LoadASCIIFromString(&model, &error, &warning, text.c_str(),
                                                static_cast<unsigned int>(text.size()), "")) {
    throw document.wrong("", error.empty() ? "a document that does not load" : error,
                         "a glTF 2.0 document");
  }
  for (size_t m = 0; m < model.meshes.size(); ++m) {
    const json& primitives = document.json["meshes"][m]["primitives"];
    for (size_t p = 0; p < primitives.size(); ++p) {
      model.meshes[m].primitives[p].indices = primitives[p].value("indices", -1);
    }
  }
  return model;
}

}  // namespace

Document read_document(const std::string& bytes, const std::string& file, const GltfOpen& open,
                       MemoryBudget* budget) {
  Container container = open_container(bytes, file);
  Document document;
  document.file = file;
  document.notices = std::move(container.notices);
  document.json = parse_text(container.json, file, budget);
  check_schema(document.json, file);
  check_version(document);
  check_required_extensions(document);
  Buffers loaded =
      load_buffers(document.json, container.binary, container.is_binary, file, open, budget);
  document.buffers = std::move(loaded.buffers);
  document.inputs = std::move(loaded.inputs);
  if (document.json.contains("buffers")) {
    for (json& buffer : document.json["buffers"]) buffer.erase("uri");  // may be most of the file
  }
  decode_meshopt_views(&document, budget);
  decode_draco_primitives(&document, budget);
  document.model = typed_model(document);
  return document;
}

const json& element_of(const Document& document, const std::string& where, const json& index,
                       const char* section) {
  const auto list = document.json.find(section);
  const bool there = list != document.json.end() && list->is_array() &&
                     index.is_number_unsigned() && index.get<uint64_t>() < list->size() &&
                     (*list)[index.get<size_t>()].is_object();
  if (!there) throw document.wrong(where, describe_json(index), std::string("one of ") + section);
  return (*list)[index.get<size_t>()];
}

std::string_view buffer_bytes(const Document& document, uint64_t buffer, uint64_t offset,
                              uint64_t length, const std::string& where) {
  if (buffer >= document.buffers.size() || !document.buffers[buffer].bytes) {
    throw document.wrong(where, "buffer " + std::to_string(buffer) + " without bytes",
                         "a buffer that holds the data");
  }
  const std::string_view bytes = *document.buffers[buffer].bytes;
  if (offset > bytes.size() || length > bytes.size() - offset) {
    throw document.wrong(where,
                         std::to_string(length) + " bytes from byte " + std::to_string(offset),
                         "an end within the " + std::to_string(bytes.size()) + " of the buffer");
  }
  return bytes.substr(offset, length);
}

std::string_view bytes_of_view(const Document& document, const std::string& where,
                               const json& index) {
  const json& view = element_of(document, where, index, "bufferViews");
  return buffer_bytes(document, view.value("buffer", uint64_t{0}),
                      view.value("byteOffset", uint64_t{0}), view.value("byteLength", uint64_t{0}),
                      where);
}

uint64_t extension_number(const Document& document, const json& extension, const char* key,
                          const std::string& where) {
  const json* const found = member_of(extension, key);
  constexpr uint64_t largest = 1ull << 53;
  if (!found || !found->is_number_unsigned() || found->get<uint64_t>() > largest) {
    throw document.wrong(where + pointer(key), found ? describe_json(*found) : "nothing",
                         "a whole number");
  }
  return found->get<uint64_t>();
}

size_t add_buffer(Document* document, std::string bytes) {
  document->json["buffers"].push_back(json{{"byteLength", bytes.size()}});
  const uint64_t length = bytes.size();
  document->buffers.push_back({length, std::move(bytes)});
  return document->buffers.size() - 1;
}

}  // namespace photorque::gltf
