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
  double scene_radius_m = 1.0;  // of the sphere about the lab origin that holds the scene
  // Receives notices of legal but implausible values (a beam that no optics can make). May be
  // empty.
  std::function<void(const std::string&)> notice;
  // Relative paths of files that a source names start here: the folder of the experiment.
  std::filesystem::path folder = {};
  // Receives name and content hash of every file read, for the provenance. May be empty.
  std::function<void(const std::string& name, const std::string& hash)> input = {};
  // The bytes of a file that lies within another, by the name that a source's key gives it. May be
  // empty.
  std::function<std::optional<std::string>(const std::string& name)> within = {};
};

// One kind of source: `kind = "led"`.
struct SourceKind {
  std::string name;
  std::string summary;  // one sentence, no full stop
  // Beams in the lab frame, at least one. Reads all of its keys; throws InputError.
  std::function<std::vector<Beam>(const Settings&, const SourceContext&)> make;
  // Keys of a typical source of this kind. The laws that every source obeys are tested on it.
  SettingsNode::Table example;
  // The keys that `make` reads, beside `kind`.
  std::vector<Key> keys = {};
};

// Every kind named in sources/CMakeLists.txt, in that order.
std::vector<SourceKind> all_source_kinds();

}  // namespace photorque
