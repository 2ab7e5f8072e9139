#include "photovoltaics/network/wiring.h"

namespace photorque {
namespace {

ArrayWiring::String string_of(const CellGroup& branch, const Diode& blocking) {
  ArrayWiring::String string{{}, blocking};
  if (branch.join != CellGroup::Join::series || branch.bypass.kind != Diode::Kind::none) {
    string.substrings.push_back({{branch}, {}});
    return string;
  }
  bool is_open = false;  // whether the last substring accepts parts without a bypass diode
  for (const CellGroup& part : branch.parts) {
    const bool bypassed = part.bypass.kind != Diode::Kind::none;
    if (bypassed || !is_open) string.substrings.push_back({{}, part.bypass});
    is_open = !bypassed;
    CellGroup inside = part;
    inside.bypass = {};
    string.substrings.back().rows.push_back(std::move(inside));
  }
  return string;
}

}  // namespace

ArrayWiring wiring_of(const CellGroup& circuit, const Diode& blocking) {
  ArrayWiring wiring;
  const bool has_branches =
      circuit.join == CellGroup::Join::parallel && circuit.bypass.kind == Diode::Kind::none;
  if (!has_branches) return {{string_of(circuit, blocking)}};
  for (const CellGroup& branch : circuit.parts) {
    wiring.strings.push_back(string_of(branch, blocking));
  }
  return wiring;
}

}  // namespace photorque
