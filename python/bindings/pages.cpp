#include "python/bindings/pages.h"

namespace photorque::python {

PageHead head_of(const RunOptions& options, const std::string& verb) {
  const std::string name = options.experiment.filename().string();
  return {options.experiment.stem().string(), verb, "photorque." + verb + "(\"" + name + "\")"};
}

}  // namespace photorque::python
