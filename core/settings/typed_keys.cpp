#include "core/settings/typed_keys.h"

#include <cmath>

#include "core/settings/read_log.h"

namespace photorque {
namespace {

// An SI number in the unit of the key, without the rounding error of the conversion: 1.8 instead of
// 1.8000000000000003.
SettingsNode in_unit_of(std::string_view key, double x_SI) {
  const double x = x_SI / unit_of_key(key).to_SI;
  return {std::isfinite(x) ? std::stod(format_setting(x)) : x};
}

Key otherwise_is(Key key, SettingsNode otherwise) {
  key.required = false;
  key.otherwise = std::move(otherwise);
  return key;
}

Key with_keys(Key table, std::vector<Key> keys) {
  table.required = false;
  table.keys = std::move(keys);
  return table;
}

}  // namespace

NumberKey::operator Key() const {
  Key key = declared(Key::Type::number);
  key.range = range;
  return otherwise ? otherwise_is(key, in_unit_of(name, *otherwise)) : key;
}
UncertainNumberKey::operator Key() const {
  Key key = declared(Key::Type::number);
  key.range = range;
  key.has_error = true;
  return otherwise ? otherwise_is(key, in_unit_of(name, otherwise->value)) : key;
}
IntegerKey::operator Key() const {
  Key key = declared(Key::Type::integer);
  key.low = low;
  key.high = high;
  return otherwise ? otherwise_is(key, {*otherwise}) : key;
}
FlagKey::operator Key() const {
  return otherwise_is(declared(Key::Type::flag), {otherwise});
}
TextKey::operator Key() const {
  const Key key = declared(Key::Type::text);
  return otherwise ? otherwise_is(key, {std::string(*otherwise)}) : key;
}
TextsKey::operator Key() const {
  return declared(Key::Type::texts);
}
Vec3Key::operator Key() const {
  const Key key = declared(Key::Type::vector);
  if (!otherwise) return key;
  SettingsNode::Array three;
  for (const double x : *otherwise) three.push_back(in_unit_of(name, x));
  return otherwise_is(key, {three});
}
Vec3sKey::operator Key() const {
  return declared(Key::Type::vectors);
}
NumbersKey::operator Key() const {
  Key key = declared(Key::Type::numbers);
  key.range = range;
  return key;
}
OtherKey::operator Key() const {
  Key key = declared(Key::Type::other);
  key.forms = forms;
  return key;
}

Vec3 direction_of(const Settings& settings, const Vec3Key& key) {
  const Vec3 direction = settings.get(key);
  if (!(direction.norm() > 0.0)) throw settings.error(key, "a zero vector", "a direction");
  return direction;
}

Key TableKey::of(std::vector<Key> keys) const {
  return with_keys(declared(Key::Type::table), std::move(keys));
}
Key TablesKey::of(std::vector<Key> keys) const {
  return with_keys(declared(Key::Type::tables), std::move(keys));
}

}  // namespace photorque
