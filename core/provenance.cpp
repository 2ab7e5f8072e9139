#include "core/provenance.h"

#include <xxhash.h>

#include "core/build_info.h"  // generated: build_version, build_git_hash

#include "core/text/format.h"

namespace photorque {

std::string Provenance::one_line() const {
  std::string line =
      program + " " + version + " (git " + git_hash + ") seed " + std::to_string(seed);
  if (!inputs.empty()) line += " inputs";
  for (const auto& [name, hash] : inputs) line += " " + name + ":" + hash.substr(0, 12);
  return line;
}

Provenance build_provenance() {
  Provenance provenance;
  provenance.version = build_version;
  provenance.git_hash = build_git_hash;
  return provenance;
}

std::string content_hash(const std::string& bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return printed("%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                 static_cast<unsigned long long>(hash.low64));
}

}  // namespace photorque
