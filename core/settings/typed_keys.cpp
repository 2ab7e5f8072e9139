#include "core/settings/typed_keys.h"

namespace photorque {
namespace {

std::string text_of(std::string_view text) {
  return std::string(text);
}

}  // namespace

NumberKey::operator Key() const {
  Key key = otherwise ? Key::number_or(text_of(name), *otherwise, range, text_of(what))
                      : Key::number(text_of(name), range, text_of(what));
  key.or_array = or_array;
  return declared(std::move(key));
}

UncertainNumberKey::operator Key() const {
  return declared(otherwise
                      ? Key::uncertain_or(text_of(name), otherwise->value, range, text_of(what))
                      : Key::uncertain(text_of(name), range, text_of(what)));
}

IntegerKey::operator Key() const {
  return declared(otherwise ? Key::integer_or(text_of(name), *otherwise, low, high, text_of(what))
                            : Key::integer(text_of(name), low, high, text_of(what)));
}

FlagKey::operator Key() const {
  return declared(Key::flag_or(text_of(name), otherwise, text_of(what)));
}

TextKey::operator Key() const {
  return declared(otherwise ? Key::text_or(text_of(name), text_of(*otherwise), text_of(what))
                            : Key::text(text_of(name), text_of(what)));
}

TextsKey::operator Key() const {
  return declared(Key::texts(text_of(name), text_of(what)));
}

Vec3Key::operator Key() const {
  return declared(otherwise ? Key::vector3_or(text_of(name), Vec3(otherwise->data()), text_of(what))
                            : Key::vector3(text_of(name), text_of(what)));
}

Vec3sKey::operator Key() const {
  return declared(Key::vectors3(text_of(name), text_of(what)));
}

NumbersKey::operator Key() const {
  return declared(Key::numbers(text_of(name), range, text_of(what)).of_size(size));
}

OtherKey::operator Key() const {
  return declared(Key::other(text_of(name), forms, text_of(what)));
}

Key TableKey::of(std::vector<Key> keys) const {
  return declared(Key::table(text_of(name), std::move(keys), text_of(what)));
}

Key TablesKey::of(std::vector<Key> keys) const {
  return declared(Key::tables(text_of(name), std::move(keys), text_of(what)));
}

}  // namespace photorque
