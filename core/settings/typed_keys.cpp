#include "core/settings/typed_keys.h"

namespace photorque {
namespace {

std::string s(std::string_view text) {
  return std::string(text);
}

}  // namespace

NumberKey::operator Key() const {
  return declared(otherwise ? Key::number_or(s(name), *otherwise, range, s(what))
                            : Key::number(s(name), range, s(what)));
}
UncertainNumberKey::operator Key() const {
  return declared(otherwise ? Key::uncertain_or(s(name), otherwise->value, range, s(what))
                            : Key::uncertain(s(name), range, s(what)));
}
IntegerKey::operator Key() const {
  return declared(otherwise ? Key::integer_or(s(name), *otherwise, low, high, s(what))
                            : Key::integer(s(name), low, high, s(what)));
}
FlagKey::operator Key() const {
  return declared(Key::flag_or(s(name), otherwise, s(what)));
}
TextKey::operator Key() const {
  return declared(otherwise ? Key::text_or(s(name), s(*otherwise), s(what))
                            : Key::text(s(name), s(what)));
}
TextsKey::operator Key() const {
  return declared(Key::texts(s(name), s(what)));
}
Vec3Key::operator Key() const {
  return declared(otherwise ? Key::vector3_or(s(name), Vec3(otherwise->data()), s(what))
                            : Key::vector3(s(name), s(what)));
}
Vec3sKey::operator Key() const {
  return declared(Key::vectors3(s(name), s(what)));
}
NumbersKey::operator Key() const {
  return declared(Key::numbers(s(name), range, s(what)));
}
OtherKey::operator Key() const {
  return declared(Key::other(s(name), forms, s(what)));
}

Vec3 direction_of(const Settings& settings, const Vec3Key& key) {
  const Vec3 direction = settings.get(key);
  if (!(direction.norm() > 0.0)) throw settings.error(key, "a zero vector", "a direction");
  return direction;
}

Key TableKey::of(std::vector<Key> keys) const {
  return declared(Key::table(s(name), std::move(keys), s(what)));
}
Key TablesKey::of(std::vector<Key> keys) const {
  return declared(Key::tables(s(name), std::move(keys), s(what)));
}

}  // namespace photorque
