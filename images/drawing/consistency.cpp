#include "images/drawing/consistency.h"

#include "core/errors.h"

namespace photorque {
namespace {

void require_count(const std::string& item, const std::string& what, size_t found,
                   size_t expected) {
  if (found == expected) return;
  throw InputError({}, item, std::to_string(found) + " " + what,
                   std::to_string(expected) + " of them");
}

}  // namespace

void require_consistent(const Map& map) {
  if (map.width < 1 || map.height < 1) {
    throw InputError({}, map.name, std::to_string(map.width) + " × " + std::to_string(map.height),
                     "a map of at least one bin");
  }
  const size_t bins = static_cast<size_t>(map.width) * static_cast<size_t>(map.height);
  require_count(map.name, "values", map.value.size(), bins);
  if (!map.standard_error.empty()) {
    require_count(map.name, "standard errors", map.standard_error.size(), bins);
  }
  if (!map.weight.empty()) require_count(map.name, "weights", map.weight.size(), bins);
}

void require_consistent(const Table& table) {
  for (const Table::Column& column : table.columns) {
    require_count(table.name + "." + column.name, "rows", column.size(),
                  table.columns.front().size());
  }
}

void require_consistent(const Plot& plot) {
  const auto check = [&](const std::vector<Plot::Curve>& curves) {
    for (const Plot::Curve& curve : curves) {
      const std::string item = plot.name + "." + curve.label;
      require_count(item, "values of y", curve.y.size(), curve.x.size());
      if (!curve.y_error.empty()) {
        require_count(item, "errors of y", curve.y_error.size(), curve.x.size());
      }
    }
  };
  check(plot.curves);
  for (const Plot::Panel& panel : plot.below) check(panel.curves);
}

}  // namespace photorque
