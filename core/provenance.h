// Provenance of a result: written into every output.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace photorque {

struct Provenance {
  std::string program = "photorque";
  std::string version;   // program version, from CMake
  std::string git_hash;  // hash of the source tree at build; "+" appended if it was modified
  uint64_t seed = 0;
  std::vector<std::pair<std::string, std::string>> inputs;  // file name, 128-bit hash in hex
  // One line for each internal check of the run that failed. The results are then unreliable.
  std::vector<std::string> warnings = {};

  // "photorque 0.1.0 (git abc123) seed 1 inputs nominal.toml:9f3c… stasis.gltf:77aa…"
  std::string one_line() const;
};

// Version and git hash of this build; seed 0, no inputs.
Provenance build_provenance();

// 128-bit non-cryptographic hash (XXH3) of bytes, as 32 hexadecimal digits.
std::string content_hash(const std::string& bytes);

}  // namespace photorque
