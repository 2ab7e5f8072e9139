#include "core/provenance.h"
#include "images/loading/functions.h"

namespace photorque {

std::string picture_build() {
  const Provenance build = build_provenance();
  return build.version + " " + build.git_hash;
}

}  // namespace photorque
