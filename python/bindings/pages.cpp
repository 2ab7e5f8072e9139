#include "python/bindings/pages.h"

#include <algorithm>

namespace photorque::python {

PageHead head_of(const RunOptions& options, const std::string& verb) {
  const std::string name = options.experiment.filename().string();
  std::string function = verb;
  std::replace(function.begin(), function.end(), '-', '_');
  return {options.experiment.stem().string(), verb, "photorque." + function + "(\"" + name + "\")"};
}

}  // namespace photorque::python
