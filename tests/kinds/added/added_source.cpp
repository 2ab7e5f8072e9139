// A kind of source that the program does not have.
#include "sources/lamps/kind.h"

namespace photorque::kinds::added_source {
namespace {

std::vector<Beam> make(const Settings& settings, const SourceContext&) {
  return {Beam{settings.text("name"), nullptr, {}, {}}};
}

}  // namespace

SourceKind kind() {
  return {"added_source", "A beam with a name and nothing else", make, {}};
}

}  // namespace photorque::kinds::added_source
