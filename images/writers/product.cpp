#include "images/writers/product.h"

#include <unistd.h>

#include <set>

#include "core/errors.h"
#include "core/settings/settings.h"
#include "images/writers/kind.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

std::vector<WriterKind> kinds_named(const std::vector<std::string>& formats) {
  const std::vector<WriterKind> all = all_writer_kinds();
  if (formats.empty()) return all;
  std::vector<WriterKind> chosen;
  for (const std::string& format : formats) {
    const auto kind = std::ranges::find(all, format, &WriterKind::name);
    if (kind == all.end()) {
      std::string known;
      for (const WriterKind& each : all) known += (known.empty() ? "" : ", ") + each.name;
      throw InputError({}, "format", "\"" + format + "\"", "one of " + known);
    }
    chosen.push_back(*kind);
  }
  return chosen;
}

// Maps and tables both become CSV, maps and plots both PNG, so a name may stand only once.
void require_distinct_files(const Product& product) {
  std::set<std::string> taken = {"summary"};  // of the JSON writer
  const auto take = [&](const std::string& name) {
    if (!taken.insert(file_in("", name, "").stem().string()).second) {
      throw InputError({}, name, "two results with this name", "different names");
    }
  };
  for (const Map& map : product.maps) take(map.name);
  for (const Table& table : product.tables) take(table.name);
  for (const Plot& plot : product.plots) take(plot.name);
}

// A folder in which files come into being, within the one where they belong; they move there when
// all are whole. What it made goes away again unless they did.
class Staging {
 public:
  explicit Staging(const fs::path& folder) : folder_(folder) {
    std::error_code failure;
    for (fs::path p = fs::absolute(folder); !fs::exists(p, failure) && p.has_relative_path();
         p = p.parent_path()) {
      made_ = p;
    }
    path_ = folder / ("." + std::to_string(::getpid()) + ".part");
    fs::create_directories(path_, failure);
    if (failure) throw InputError({folder.string()}, "", failure.message(), "a writable folder");
  }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;
  ~Staging() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    if (!moved_ && !made_.empty()) fs::remove_all(made_, ignored);
  }

  const fs::path& path() const { return path_; }

  std::vector<fs::path> move(const std::vector<fs::path>& files) {
    std::vector<fs::path> places;
    for (const fs::path& file : files) {
      places.push_back(folder_ / file.filename());
      std::error_code failure;
      fs::rename(file, places.back(), failure);
      if (failure) {
        throw InputError({places.back().string()}, "", failure.message(),
                         "a path that can be written");
      }
    }
    moved_ = true;
    return places;
  }

 private:
  fs::path folder_, path_, made_;
  bool moved_ = false;
};

}  // namespace

fs::path file_in(const fs::path& folder, const std::string& name, const std::string& extension) {
  std::string stem;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '_' || c == '-' || (c == '.' && !stem.empty());
    stem += plain ? c : '_';
  }
  return folder / ((stem.empty() ? "unnamed" : stem) + "." + extension);
}

std::vector<fs::path> write_product(const Product& product, const Provenance& provenance,
                                    const fs::path& folder,
                                    const std::vector<std::string>& formats) {
  require_distinct_files(product);
  const std::vector<WriterKind> kinds = kinds_named(formats);
  Staging staging(folder);
  std::vector<fs::path> paths;
  for (const WriterKind& kind : kinds) {
    const std::vector<fs::path> written = kind.make()->write(product, provenance, staging.path());
    paths.insert(paths.end(), written.begin(), written.end());
  }
  return staging.move(paths);
}

}  // namespace photorque
