#include "scenes/gltf/file/schema.h"

#include <algorithm>
#include <sstream>
#include <string_view>

#include "core/errors.h"
#include "scenes/gltf/file/fault.h"
#include "scenes/gltf/file/properties.h"

namespace photorque::gltf {
namespace {

using nlohmann::json;

// Walks a document beside the tables.
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
  std::ostringstream range;
  range.precision(16);
  if (field.low > -1e308) range << " >= " << field.low;
  if (field.high < 1e308) range << (field.low > -1e308 ? " and" : "") << " <= " << field.high;
  switch (field.shape) {
    case Shape::integer:
      return (field.multiple > 1 ? "a multiple of " + std::to_string(field.multiple)
                                 : "an integer") +
             range.str();
    case Shape::number:
      return "a number" + range.str();
    case Shape::numbers:
      return (field.length > 0 ? std::to_string(field.length) + " numbers" : "numbers") +
             range.str();
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

// The value itself, not what is inside it.
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
  if (field.shape == Shape::object && field.inner != nullptr) members(value, where, *field.inner);
  if (field.shape == Shape::objects) {
    for (size_t i = 0; i < value.size(); ++i) members(value[i], where + pointer(i), *field.inner);
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

void check_schema(const json& document, const std::string& file) {
  if (!document.is_object()) {
    throw InputError({file}, "", describe_json(document), "a JSON object");
  }
  SchemaWalk(document, file).members(document, "", properties::document);
}

}  // namespace photorque::gltf
