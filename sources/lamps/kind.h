// Conversion of `[[source]]` of an experiment into beams.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/settings/keys.h"
#include "core/settings/settings.h"
#include "raytrace/emitter.h"

namespace photorque {

// Properties of the lit scene that a source may need.
struct SourceContext {
  double scene_radius_m = 1.0;  // of the sphere about the lab origin that contains the scene
  // Receives notices of legal but implausible values (such as a beam that optics cannot produce).
  // May be empty.
  std::function<void(const std::string&)> notice = {};
  // Folder of the experiment; relative paths of files that a source names start here.
  std::filesystem::path folder = {};
  // Receives name and content hash of every file read, for the provenance. May be empty.
  std::function<void(const std::string& name, const std::string& hash)> input = {};
  // Returns the bytes of a file that is embedded in another, by the name in the source's key. May
  // be empty.
  std::function<std::optional<std::string>(const std::string& name)> within = {};
};

// One kind of source: `kind = "led"`.
struct SourceKind {
  std::string name;
  std::string summary;  // one sentence, no full stop
  // Makes at least one beam in the lab frame. Reads all keys of the kind; throws InputError for
  // invalid ones.
  std::function<std::vector<Beam>(const Settings&, const SourceContext&)> make;
  // Keys that `make` reads, in addition to `kind`.
  std::vector<Key> keys = {};
};

// All kinds listed in sources/CMakeLists.txt, in that order.
std::vector<SourceKind> all_source_kinds();

}  // namespace photorque
