#include "tools/keys/registry.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/text/format.h"

namespace photorque {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const SettingsNode& node) {
  if (const auto* flag = std::get_if<bool>(&node.value)) return *flag;
  if (const auto* whole = std::get_if<int64_t>(&node.value)) return *whole;
  if (const auto* real = std::get_if<double>(&node.value)) return *real;
  if (const auto* text = std::get_if<std::string>(&node.value)) return *text;
  Json all = Json::array();
  for (const SettingsNode& item : std::get<SettingsNode::Array>(node.value)) {
    all.push_back(json_of(item));
  }
  return all;
}

// Schema of a number in a unit of the key.
Json number_schema(Range range, double to_SI) {
  Json schema = {{"type", "number"}};
  const auto bound = [&](double SI) { return std::stod(short_number(SI / to_SI)); };
  const bool turned = to_SI < 0.0;
  if (range.low > -1e307 && !turned) {
    schema[range.low_open ? "exclusiveMinimum" : "minimum"] = bound(range.low);
  }
  if (range.high < 1e307 && !turned) {
    schema[range.high_open ? "exclusiveMaximum" : "maximum"] = bound(range.high);
  }
  return schema;
}

Json array_of(Json items, size_t size) {
  Json schema = {{"type", "array"}, {"items", std::move(items)}};
  if (size > 0) schema["minItems"] = schema["maxItems"] = size;
  return schema;
}

Json vector_schema() {
  return array_of({{"type", "number"}}, 3);
}

// Named schemas of tables to which the schema refers more than once.
class Definitions {
 public:
  // Reference to a schema with this name; a number is appended if the name belongs to another
  // schema.
  Json reference(const std::string& name, Json schema) {
    std::string own = name;
    for (int number = 2; all_.contains(own) && all_[own] != schema; ++number) {
      own = name + "_" + std::to_string(number);
    }
    all_[own] = std::move(schema);
    return {{"$ref", "#/definitions/" + own}};
  }
  const Json& all() const { return all_; }

 private:
  Json all_ = Json::object();
};

Json object_schema(const std::vector<Key>& keys, Definitions& definitions);

Json several_forms(unsigned forms) {
  Json types = Json::array();
  if ((forms & Key::a_number) != 0) types.push_back("number");
  if ((forms & Key::an_array) != 0) types.push_back("array");
  if ((forms & (Key::a_text | Key::a_date)) != 0) types.push_back("string");
  if ((forms & Key::a_table) != 0) types.push_back("object");
  if ((forms & Key::a_flag) != 0) types.push_back("boolean");
  return {{"type", types.size() == 1 ? types[0] : types}};
}

Json plain_schema(const Key& key, double to_SI, Definitions& definitions) {
  switch (key.type) {
    case Key::Type::number: {
      Json one = number_schema(key.range, to_SI);
      if (!key.or_array) return one;
      return {{"anyOf", {one, array_of(one, key.size)}}};
    }
    case Key::Type::numbers:
      return array_of(number_schema(key.range, to_SI), key.size);
    case Key::Type::integer: {
      Json schema = {{"type", "integer"}, {"minimum", key.low}};
      if (key.high != INT64_MAX) schema["maximum"] = key.high;
      return schema;
    }
    case Key::Type::flag:
      return {{"type", "boolean"}};
    case Key::Type::text:
      return {{"type", "string"}};
    case Key::Type::texts:
      return {{"type", "array"}, {"items", {{"type", "string"}}}};
    case Key::Type::choice: {
      Json names = Json::array();
      for (const Key::Choice& choice : key.choices) names.push_back(choice.name);
      return {{"type", "string"}, {"enum", names}};
    }
    case Key::Type::vector:
      return vector_schema();
    case Key::Type::vectors: {
      Json schema = array_of(vector_schema(), 0);
      schema["minItems"] = 1;
      return schema;
    }
    case Key::Type::table:
      return object_schema(key.keys, definitions);
    case Key::Type::tables: {
      const Json one = definitions.reference(key.name, object_schema(key.keys, definitions));
      // A single table [name] is accepted as one of [[name]].
      return {{"anyOf", {{{"type", "array"}, {"items", one}}, one}}};
    }
    case Key::Type::other:
      break;
  }
  return several_forms(key.forms);
}

// Schema of a value in the unit with the factor `to_SI`.
Json value_schema(const Key& key, double to_SI, Definitions& definitions) {
  Json plain = plain_schema(key, to_SI, definitions);
  if (key.has_error) {
    Json sigma = plain_schema(key, to_SI, definitions);
    for (const char* bound : {"minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"}) {
      sigma.erase(bound);
    }
    plain = {{"anyOf",
              {plain,
               {{"type", "object"},
                {"properties", {{"value", plain}, {"sigma", sigma}}},
                {"required", {"value", "sigma"}},
                {"additionalProperties", false}}}}};
  }
  return plain;
}

Json described(const Key& key, const KeyUnit& unit, Definitions& definitions) {
  Json schema = {{"description", description_of(key)}};
  if (key.otherwise && unit_of_key(key.name).unit == unit.unit) {
    schema["default"] = json_of(*key.otherwise);
  }
  schema.update(value_schema(key, unit.to_SI, definitions));
  return schema;
}

// Accepted names of a key: its own, and those of the same quantity in other units.
std::vector<std::string> names_of(const Key& key) {
  const KeyUnit own = unit_of_key(key.name);
  std::vector<std::string> names = {key.name};
  if (own.unit.empty()) return names;
  for (const KeyUnit& unit : units_of(own.dimension)) {
    if (unit.unit != own.unit) names.push_back(own.stem + "_" + unit.unit);
  }
  return names;
}

// Names of a key as a regular expression: "pitch_(m|mm|cm)".
std::string pattern_of(const Key& key) {
  const KeyUnit own = unit_of_key(key.name);
  if (own.unit.empty()) return key.name;
  const std::string units = joined_text(units_of(own.dimension), "|", &KeyUnit::unit);
  return own.stem + "_(" + units + ")";
}

// Identifier of the quantity of a key, common to all its units.
std::string quantity_of(const Key& key) {
  const KeyUnit unit = unit_of_key(key.name);
  return unit.unit.empty() ? key.name : unit.stem + " of " + unit.dimension;
}

// Every key that a table can contain, with any of its choices.
void flatten(const std::vector<Key>& keys, std::vector<const Key*>& all) {
  for (const Key& key : keys) {
    all.push_back(&key);
    for (const Key::Choice& choice : key.choices) flatten(choice.keys, all);
  }
}

std::vector<const Key*> flat(const std::vector<Key>& keys) {
  std::vector<const Key*> all;
  flatten(keys, all);
  return all;
}

// Schema of a table.
class ObjectSchema {
 public:
  ObjectSchema(const std::vector<Key>& keys, Definitions& definitions)
      : keys_(keys), definitions_(definitions) {
    for (const Key* key : flat(keys)) variants_[quantity_of(*key)].push_back(key);
  }

  Json schema() {
    Json schema = {{"type", "object"}, {"properties", Json::object()}};
    Json patterns = Json::object();
    std::set<std::string> done;
    for (const Key* key : flat(keys_)) {
      if (done.insert(key->name).second) add_property(*key, schema["properties"], patterns);
    }
    if (!patterns.empty()) schema["patternProperties"] = std::move(patterns);
    schema["additionalProperties"] = false;
    Json conditions = required(keys_);
    for (Json& one : choices(keys_)) conditions.push_back(std::move(one));
    if (!conditions.empty()) {
      schema["if"] = Json::object();
      schema["then"] = {{"allOf", std::move(conditions)}};
    }
    return schema;
  }

 private:
  // Whether all keys of this quantity have the same schema in every choice.
  bool is_one(const Key& key) const {
    const std::vector<const Key*>& same = variants_.at(quantity_of(key));
    const double to_SI = unit_of_key(key.name).to_SI;
    const Json first = value_schema(*same.front(), to_SI, definitions_);
    return std::ranges::all_of(
        same, [&](const Key* other) { return value_schema(*other, to_SI, definitions_) == first; });
  }

  void add_property(const Key& key, Json& properties, Json& patterns) const {
    const KeyUnit own = unit_of_key(key.name);
    const bool one = is_one(key);
    properties[key.name] =
        one ? described(key, own, definitions_) : Json{{"description", description_of(key)}};
    if (own.unit.empty()) return;
    // Units with equal schemas (such as bounds of zero) share one entry.
    std::map<std::string, std::string> units_with;  // schema as text → units
    for (const KeyUnit& unit : units_of(own.dimension)) {
      if (unit.unit == own.unit) continue;
      Json schema = {{"description", "`" + key.name + "` in another unit."}};
      if (one) schema.update(value_schema(key, unit.to_SI, definitions_));
      std::string& units = units_with[schema.dump()];
      units += (units.empty() ? "" : "|") + unit.unit;
    }
    for (const auto& [schema, units] : units_with) {
      patterns["^" + own.stem + "_(" + units + ")$"] = Json::parse(schema);
    }
  }

  Json required(const std::vector<Key>& keys) const {
    Json all = Json::array(), plain = Json::array();
    Json instead = Json::array();
    for (const Key& key : keys) {
      if (key.completes) instead.push_back({{"required", {key.name}}});
      if (!key.required) continue;
      const std::vector<std::string> names = names_of(key);
      if (names.size() == 1) {
        plain.push_back(key.name);
        continue;
      }
      Json any = Json::array();
      for (const std::string& name : names) any.push_back({{"required", {name}}});
      all.push_back({{"anyOf", std::move(any)}});
    }
    if (!plain.empty()) all.push_back({{"required", std::move(plain)}});
    if (instead.empty() || all.empty()) return all;
    instead.push_back({{"allOf", std::move(all)}});
    return Json::array({{{"anyOf", std::move(instead)}}});
  }

  // Keys that each value of each choice allows and requires.
  Json choices(const std::vector<Key>& keys) const {
    Json all = Json::array();
    for (const Key& key : keys) {
      bool brings = false;
      for (const Key::Choice& choice : key.choices) brings = brings || !choice.keys.empty();
      if (!brings) continue;
      for (const Key::Choice& choice : key.choices) all.push_back(condition(keys, key, choice));
    }
    return all;
  }

  Json condition(const std::vector<Key>& keys, const Key& key, const Key::Choice& choice) const {
    Json is_so = {{"properties", {{key.name, {{"const", choice.name}}}}}};
    const bool is_default = key.otherwise && json_of(*key.otherwise) == choice.name;
    if (!is_default) is_so["required"] = Json::array({key.name});
    Json then = {{"propertyNames", {{"pattern", "^(" + allowed(key, choice) + ")$"}}}};
    Json properties = Json::object(), patterns = Json::object();
    const ObjectSchema inner(choice.keys,
                             definitions_);  // keys of deeper choices are handled by those
    for (const Key* own : flat(choice.keys)) {
      if (is_one(*own) || !inner.is_one(*own)) continue;
      const KeyUnit unit = unit_of_key(own->name);
      properties[own->name] = described(*own, unit, definitions_);
      if (unit.unit.empty()) continue;
      for (const KeyUnit& other : units_of(unit.dimension)) {
        if (other.unit == unit.unit) continue;
        patterns["^" + unit.stem + "_" + other.unit + "$"] = described(*own, other, definitions_);
      }
    }
    if (!properties.empty()) then["properties"] = std::move(properties);
    if (!patterns.empty()) then["patternProperties"] = std::move(patterns);
    Json more = choices(choice.keys);
    for (Json& one : completed(keys, choice)) more.push_back(std::move(one));
    if (!more.empty()) then["allOf"] = std::move(more);
    return {{"if", std::move(is_so)}, {"then", std::move(then)}};
  }

  // Keys that a choice requires, unless another key replaces them.
  Json completed(const std::vector<Key>& keys, const Key::Choice& choice) const {
    std::vector<Key> own = choice.keys;
    for (const Key& key : keys) {
      if (key.completes) own.push_back(key);
    }
    return required(own);
  }

  // All names that the table may contain with this choice: all except those that only other choices
  // of the same key add.
  std::string allowed(const Key& key, const Key::Choice& choice) const {
    std::set<std::string> others, mine;
    for (const Key::Choice& other : key.choices) {
      for (const Key* one : flat(other.keys)) others.insert(quantity_of(*one));
    }
    for (const Key* one : flat(choice.keys)) mine.insert(quantity_of(*one));
    // Keys that exist independently of this key are allowed.
    for (const Key& one : keys_) {
      mine.insert(quantity_of(one));
      if (one.name == key.name || holds(one, key)) continue;
      for (const Key::Choice& brings : one.choices) {
        for (const Key* other : flat(brings.keys)) mine.insert(quantity_of(*other));
      }
    }
    std::string names;
    for (const auto& [quantity, variants] : variants_) {
      if (others.contains(quantity) && !mine.contains(quantity)) continue;
      names += (names.empty() ? "" : "|") + pattern_of(*variants.front());
    }
    return names;
  }

  // Whether `inner` is among the keys that the choices of `outer` add.
  static bool holds(const Key& outer, const Key& inner) {
    for (const Key::Choice& choice : outer.choices) {
      for (const Key* one : flat(choice.keys)) {
        if (one == &inner) return true;
      }
    }
    return false;
  }

  const std::vector<Key>& keys_;
  Definitions& definitions_;
  std::map<std::string, std::vector<const Key*>> variants_;
};

Json object_schema(const std::vector<Key>& keys, Definitions& definitions) {
  return ObjectSchema(keys, definitions).schema();
}

}  // namespace

std::string json_schema(const std::vector<Key>& tables) {
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                 {"title", "An experiment of photorque"},
                 {"description",
                  "Written by `photorque schema`. The name of a key ends with its unit; other "
                  "units of the same quantity are accepted."}};
  Definitions definitions;
  schema.update(object_schema(tables, definitions));
  schema["definitions"] = definitions.all();
  return schema.dump(1) + "\n";
}

}  // namespace photorque
