// What the kinds of source that are read from a file share.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/settings/settings.h"
#include "sources/kind.h"

namespace photorque {

// The bytes of the file that the key `file` names, relative to the context's folder; its hash goes
// to the context. `name` is how messages call it.
struct SourceFile {
  std::string name;
  std::string bytes;
};
SourceFile read_source_file(const Settings& settings, const SourceContext& context);

// One lamp at position_m, called `name`, or the same lamp at each of positions_m, called name[0],
// name[1] …; each looks along `direction` or at aim_m, turned by turn_deg (default 0) about its
// beam. `aperture` as in Beam.
std::vector<Beam> place_lamps(const Settings& settings, const std::string& name,
                              const std::shared_ptr<const Emitter>& lamp, const Spectrum& spectrum,
                              const std::optional<UniformAperture>& aperture = std::nullopt);

}  // namespace photorque
