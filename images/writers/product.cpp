#include "images/writers/product.h"

#include <set>

#include "core/errors.h"
#include "core/settings/settings.h"
#include "core/text/format.h"
#include "images/writers/kind.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

std::vector<WriterKind> kinds_named(const std::vector<std::string>& formats) {
  std::vector<WriterKind> all = all_writer_kinds();
  if (formats.empty()) return all;
  std::vector<WriterKind> chosen;
  for (const std::string& format : formats) {
    const auto kind = std::ranges::find(all, format, &WriterKind::name);
    if (kind == all.end()) {
      const std::string known = joined_text(all, ", ", &WriterKind::name);
      throw InputError({}, "format", "\"" + format + "\"", "one of " + known);
    }
    chosen.push_back(*kind);
  }
  return chosen;
}

// Maps and tables both become CSV files, maps and plots both PNG files, so names must be unique.
void require_distinct_files(const Product& product) {
  std::set<std::string> taken = {"summary"};  // used by the JSON writer
  const auto take = [&](const std::string& name) {
    if (!taken.insert(file_in("", name, "").stem().string()).second) {
      throw InputError({}, name, "two results with this name", "different names");
    }
  };
  for (const Map& map : product.maps) take(map.name);
  for (const Table& table : product.tables) take(table.name);
  for (const Plot& plot : product.plots) take(plot.name);
}

}  // namespace

void require_consistent(const Table& table) {
  for (const Table::Column& column : table.columns) {
    if (column.size() == table.columns.front().size()) continue;
    throw InputError({}, table.name + "." + column.name, std::to_string(column.size()) + " rows",
                     std::to_string(table.columns.front().size()) + " of them");
  }
}

fs::path file_in(const fs::path& folder, const std::string& name, const std::string& extension) {
  std::string stem;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '_' || c == '-' || (c == '.' && !stem.empty());
    stem += plain ? c : '_';
  }
  return folder / ((stem.empty() ? "unnamed" : stem) + "." + extension);
}

void require_formats(const std::vector<std::string>& formats) {
  kinds_named(formats);
}

std::vector<fs::path> write_formats(const Product& product, const Provenance& provenance,
                                    const fs::path& folder, const std::vector<std::string>& formats,
                                    PictureStyle style) {
  require_distinct_files(product);
  std::vector<fs::path> paths;
  for (const WriterKind& kind : kinds_named(formats)) {
    const std::vector<fs::path> written = kind.write({product, provenance, folder, style});
    paths.insert(paths.end(), written.begin(), written.end());
  }
  return paths;
}

}  // namespace photorque
