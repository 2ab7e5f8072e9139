// Which formats there are.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "images/writers/writer.h"

namespace photorque {

// One format: "exr".
struct WriterKind {
  std::string name;     // also the extension of its files
  std::string summary;  // one sentence, no full stop
  std::function<std::unique_ptr<Writer>()> make;
};

// Every kind named in images/CMakeLists.txt, in that order.
std::vector<WriterKind> all_writer_kinds();

}  // namespace photorque
