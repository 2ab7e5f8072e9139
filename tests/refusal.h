// Messages about wrong input.
#pragma once

#include <string>

#include "core/errors.h"

namespace photorque {

// The message of the InputError that `act` throws; empty if it throws none.
template <class Act>
std::string refusal_of(const Act& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace photorque
