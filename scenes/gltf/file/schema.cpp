#include "scenes/gltf/file/fault.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <sstream>

#include "core/errors.h"
#include "core/text/format.h"

namespace photorque::gltf {

namespace {

// Tables of the members of a glTF document on which the reader depends.
//
// They follow the specification (glTF 2.0, section 5 "Properties Reference") and the READMEs of the
// named extensions, member by member.

// Type of a value.
enum class Shape {
  integer,
  number,
  numbers,
  text,
  flag,
  object,
  objects,         // an array of objects
  reference,       // an index into the list `target`
  references,      // an array of them
  reference_map,   // an object whose members are references
  reference_maps,  // an array of those
};

struct Field;

// Members of one kind of object.
struct Fields {
  const Field* first = nullptr;
  size_t count = 0;

  constexpr Fields() = default;
  template <size_t n>
  constexpr Fields(const Field (&list)[n]) : first(list), count(n) {}
  const Field* begin() const;
  const Field* end() const;
};

// One member of an object.
struct Field {
  const char* key;
  Shape shape;
  bool required = false;
  double low = -1e308;  // of integer, number and each of numbers
  double high = 1e308;
  uint64_t multiple = 1;          // of integer: the value must be a multiple of this
  size_t length = 0;              // of numbers: required count; 0 for any
  const char* choices = nullptr;  // of integer and text: the allowed values, separated by spaces
  const char* target = nullptr;   // of references
  const char* beside = nullptr;   // legal only together with this member
  const char* without = nullptr;  // illegal together with this member
  Fields inner = {};              // of object and objects; empty: any members
  bool may_be_empty = false;      // of arrays: an empty one is allowed and has no effect
};

const Field* Fields::begin() const {
  return first;
}
const Field* Fields::end() const {
  return first + count;
}

namespace properties {

// Integers beyond 2^53 are not preserved by other JSON parsers (section 2.7).
constexpr double largest_integer = 9007199254740992.0;
// tinygltf stores the members of sparse accessors as int.
constexpr double largest_int = 2147483647.0;
constexpr const char* index_types = "5121 5123 5125";
constexpr const char* component_types = "5120 5121 5122 5123 5125 5126";
constexpr const char* element_types = "SCALAR VEC2 VEC3 VEC4 MAT2 MAT3 MAT4";

constexpr Field asset[] = {
    {.key = "version", .shape = Shape::text, .required = true},
    {.key = "minVersion", .shape = Shape::text},
};

constexpr Field byte_length = {.key = "byteLength",
                               .shape = Shape::integer,
                               .required = true,
                               .low = 1,
                               .high = largest_integer};

constexpr Field buffer[] = {
    byte_length,
    {.key = "uri", .shape = Shape::text},
};

constexpr Field buffer_view[] = {
    {.key = "buffer", .shape = Shape::reference, .required = true, .target = "buffers"},
    {.key = "byteOffset", .shape = Shape::integer, .low = 0, .high = largest_integer},
    byte_length,
    {.key = "byteStride", .shape = Shape::integer, .low = 4, .high = 252, .multiple = 4},
    {.key = "target", .shape = Shape::integer, .choices = "34962 34963"},
};

constexpr Field sparse_indices[] = {
    {.key = "bufferView", .shape = Shape::reference, .required = true, .target = "bufferViews"},
    {.key = "byteOffset", .shape = Shape::integer, .low = 0, .high = largest_int},
    {.key = "componentType", .shape = Shape::integer, .required = true, .choices = index_types},
};

constexpr Field sparse_values[] = {
    {.key = "bufferView", .shape = Shape::reference, .required = true, .target = "bufferViews"},
    {.key = "byteOffset", .shape = Shape::integer, .low = 0, .high = largest_int},
};

constexpr Field sparse[] = {
    {.key = "count", .shape = Shape::integer, .required = true, .low = 1, .high = largest_int},
    {.key = "indices", .shape = Shape::object, .required = true, .inner = sparse_indices},
    {.key = "values", .shape = Shape::object, .required = true, .inner = sparse_values},
};

constexpr Field accessor[] = {
    {.key = "bufferView", .shape = Shape::reference, .target = "bufferViews"},
    {.key = "byteOffset",
     .shape = Shape::integer,
     .low = 0,
     .high = largest_integer,
     .beside = "bufferView"},
    {.key = "componentType", .shape = Shape::integer, .required = true, .choices = component_types},
    {.key = "normalized", .shape = Shape::flag},
    {.key = "count", .shape = Shape::integer, .required = true, .low = 1, .high = largest_integer},
    {.key = "type", .shape = Shape::text, .required = true, .choices = element_types},
    {.key = "sparse", .shape = Shape::object, .inner = sparse},
};

constexpr Field metallic_roughness[] = {
    {.key = "baseColorFactor", .shape = Shape::numbers, .low = 0, .high = 1, .length = 4},
    {.key = "metallicFactor", .shape = Shape::number, .low = 0, .high = 1},
    {.key = "roughnessFactor", .shape = Shape::number, .low = 0, .high = 1},
    {.key = "baseColorTexture", .shape = Shape::object},
};

constexpr Field specular_glossiness[] = {
    {.key = "diffuseFactor", .shape = Shape::numbers, .low = 0, .high = 1, .length = 4},
    {.key = "specularFactor", .shape = Shape::numbers, .low = 0, .high = 1, .length = 3},
    {.key = "glossinessFactor", .shape = Shape::number, .low = 0, .high = 1},
    {.key = "diffuseTexture", .shape = Shape::object},
};

constexpr Field transmission[] = {
    {.key = "transmissionFactor", .shape = Shape::number, .low = 0, .high = 1},
};

constexpr Field ior[] = {{.key = "ior", .shape = Shape::number, .low = 0}};

constexpr Field material_extensions[] = {
    {.key = "KHR_materials_transmission", .shape = Shape::object, .inner = transmission},
    {.key = "KHR_materials_ior", .shape = Shape::object, .inner = ior},
    {.key = "KHR_materials_pbrSpecularGlossiness",
     .shape = Shape::object,
     .inner = specular_glossiness},
};

constexpr Field material[] = {
    {.key = "name", .shape = Shape::text},
    {.key = "pbrMetallicRoughness", .shape = Shape::object, .inner = metallic_roughness},
    {.key = "alphaMode", .shape = Shape::text, .choices = "OPAQUE MASK BLEND"},
    {.key = "alphaCutoff", .shape = Shape::number, .low = 0},
    {.key = "doubleSided", .shape = Shape::flag},
    {.key = "extensions", .shape = Shape::object, .inner = material_extensions},
};

constexpr Field primitive[] = {
    {.key = "attributes", .shape = Shape::reference_map, .required = true, .target = "accessors"},
    {.key = "indices", .shape = Shape::reference, .target = "accessors"},
    {.key = "material", .shape = Shape::reference, .target = "materials"},
    {.key = "mode", .shape = Shape::integer, .low = 0, .high = 6},
    {.key = "targets", .shape = Shape::reference_maps, .target = "accessors"},
    {.key = "extensions", .shape = Shape::object},
};

constexpr Field mesh[] = {
    {.key = "primitives", .shape = Shape::objects, .required = true, .inner = primitive},
    {.key = "weights", .shape = Shape::numbers},
};

constexpr Field instancing[] = {
    {.key = "attributes", .shape = Shape::reference_map, .required = true, .target = "accessors"},
};

constexpr Field node_extensions[] = {
    {.key = "EXT_mesh_gpu_instancing", .shape = Shape::object, .inner = instancing},
};

constexpr Field node[] = {
    {.key = "name", .shape = Shape::text},
    {.key = "children", .shape = Shape::references, .target = "nodes", .may_be_empty = true},
    {.key = "mesh", .shape = Shape::reference, .target = "meshes"},
    {.key = "skin", .shape = Shape::reference, .target = "skins", .beside = "mesh"},
    {.key = "camera", .shape = Shape::reference, .target = "cameras"},
    {.key = "weights", .shape = Shape::numbers},
    {.key = "matrix", .shape = Shape::numbers, .length = 16},
    {.key = "translation", .shape = Shape::numbers, .length = 3, .without = "matrix"},
    {.key = "rotation", .shape = Shape::numbers, .length = 4, .without = "matrix"},
    {.key = "scale", .shape = Shape::numbers, .length = 3, .without = "matrix"},
    {.key = "extensions", .shape = Shape::object, .inner = node_extensions},
};

constexpr Field scene[] = {
    {.key = "nodes", .shape = Shape::references, .target = "nodes", .may_be_empty = true},
};

constexpr Field document[] = {
    {.key = "asset", .shape = Shape::object, .required = true, .inner = asset},
    {.key = "buffers", .shape = Shape::objects, .inner = buffer},
    {.key = "bufferViews", .shape = Shape::objects, .inner = buffer_view},
    {.key = "accessors", .shape = Shape::objects, .inner = accessor},
    {.key = "materials", .shape = Shape::objects, .inner = material},
    {.key = "meshes", .shape = Shape::objects, .inner = mesh},
    {.key = "nodes", .shape = Shape::objects, .inner = node},
    {.key = "scenes", .shape = Shape::objects, .inner = scene},
    {.key = "scene", .shape = Shape::reference, .target = "scenes"},
};

}  // namespace properties

using nlohmann::json;

// Checks a document against the tables.
class SchemaWalk {
 public:
  SchemaWalk(const json& root, const std::string& file) : root_(root), file_(file) {}

  void members(const json& value, const std::string& where, const Fields& expected) const {
    for (const Field& field : expected) {
      const std::string here = where + pointer(field.key);
      const auto found = value.find(field.key);
      if (found == value.end()) {
        if (field.required) throw wrong(here, "nothing", expectation(field));
        continue;
      }
      if (field.beside != nullptr && !value.contains(field.beside)) {
        throw wrong(here, "it without " + std::string(field.beside), "both or none");
      }
      if (field.without != nullptr && value.contains(field.without)) {
        throw wrong(here, "it together with " + std::string(field.without), "one of them");
      }
      check(*found, here, field);
    }
  }

 private:
  InputError wrong(const std::string& where, const std::string& found,
                   const std::string& expected) const {
    return {{file_}, where, found, expected};
  }

  size_t length_of(const char* list) const {
    const auto found = root_.find(list);
    return found != root_.end() && found->is_array() ? found->size() : 0;
  }

  std::string expectation(const Field& field) const;
  bool fits(const json& value, const Field& field) const;
  void check(const json& value, const std::string& where, const Field& field) const;

  const json& root_;
  const std::string& file_;
};

bool is_choice(const json& value, const char* choices) {
  const std::string word = value.is_string() ? value.get<std::string>() : value.dump();
  std::istringstream list(choices);
  for (std::string choice; list >> choice;) {
    if (choice == word) return true;
  }
  return false;
}

std::string SchemaWalk::expectation(const Field& field) const {
  if (field.choices != nullptr) return "one of " + std::string(field.choices);
  std::string range;
  if (field.low > -1e308) range += printed(" >= %.16g", field.low);
  if (field.high < 1e308) range += (range.empty() ? "" : " and") + printed(" <= %.16g", field.high);
  switch (field.shape) {
    case Shape::integer:
      return (field.multiple > 1 ? "a multiple of " + std::to_string(field.multiple)
                                 : "an integer") +
             range;
    case Shape::number:
      return "a number" + range;
    case Shape::numbers:
      return (field.length > 0 ? std::to_string(field.length) + " numbers" : "numbers") + range;
    case Shape::text:
      return "a text";
    case Shape::flag:
      return "true or false";
    case Shape::object:
      return "an object";
    case Shape::objects:
      return "an array of objects, not empty";
    case Shape::reference:
      return "an index below " + std::to_string(length_of(field.target)) + ", the number of " +
             field.target;
    case Shape::references:
      return "indices below " + std::to_string(length_of(field.target)) + ", the number of " +
             field.target;
    case Shape::reference_map:
    case Shape::reference_maps:
      break;
  }
  return "an object of indices below " + std::to_string(length_of(field.target)) +
         ", the number of " + field.target + ", not empty";
}

// Checks the value itself, without its members.
bool SchemaWalk::fits(const json& value, const Field& field) const {
  const auto in_range = [&](const json& number) {
    return number.is_number() && number.get<double>() >= field.low &&
           number.get<double>() <= field.high;
  };
  if (field.choices != nullptr && !is_choice(value, field.choices)) return false;
  switch (field.shape) {
    case Shape::integer:
      return value.is_number_integer() && in_range(value) &&
             value.get<uint64_t>() % field.multiple == 0;
    case Shape::number:
      return in_range(value);
    case Shape::numbers:
      return value.is_array() && (field.length == 0 || value.size() == field.length) &&
             std::all_of(value.begin(), value.end(), in_range);
    case Shape::text:
      return value.is_string();
    case Shape::flag:
      return value.is_boolean();
    case Shape::object:
      return value.is_object();
    case Shape::objects:
      return value.is_array() && !value.empty() &&
             std::all_of(value.begin(), value.end(), [](const json& v) { return v.is_object(); });
    case Shape::reference:
      return value.is_number_unsigned() && value.get<uint64_t>() < length_of(field.target);
    case Shape::references:
    case Shape::reference_maps:
      return value.is_array() && (field.may_be_empty || !value.empty());
    case Shape::reference_map:
      break;
  }
  return value.is_object() && !value.empty();
}

void SchemaWalk::check(const json& value, const std::string& where, const Field& field) const {
  if (!fits(value, field)) throw wrong(where, describe_json(value), expectation(field));
  if (field.shape == Shape::object && field.inner.count > 0) members(value, where, field.inner);
  if (field.shape == Shape::objects) {
    for (size_t i = 0; i < value.size(); ++i) members(value[i], where + pointer(i), field.inner);
  }
  if (field.shape == Shape::references || field.shape == Shape::reference_maps) {
    Field item = field;
    item.shape = field.shape == Shape::references ? Shape::reference : Shape::reference_map;
    for (size_t i = 0; i < value.size(); ++i) check(value[i], where + pointer(i), item);
  }
  if (field.shape == Shape::reference_map) {
    Field item = field;
    item.shape = Shape::reference;
    for (const auto& [key, inner] : value.items()) check(inner, where + pointer(key), item);
  }
}

}  // namespace

std::string describe_json(const json& value) {
  if (value.is_array()) return "an array of " + std::to_string(value.size());
  if (value.is_object()) return value.empty() ? "an empty object" : "an object";
  constexpr size_t longest = 60;
  const std::string text = value.dump();
  return text.size() <= longest ? text : text.substr(0, longest) + "...";
}

const json* member_of(const json& value, const char* key) {
  if (!value.is_object()) return nullptr;
  const auto found = value.find(key);
  return found == value.end() ? nullptr : &*found;
}

const json* extension_of(const json& value, const char* name) {
  const json* const extensions = member_of(value, "extensions");
  return extensions ? member_of(*extensions, name) : nullptr;
}

void check_schema(const json& document, const std::string& file) {
  if (!document.is_object()) {
    throw InputError({file}, "", describe_json(document), "a JSON object");
  }
  SchemaWalk(document, file).members(document, "", properties::document);
}

}  // namespace photorque::gltf
