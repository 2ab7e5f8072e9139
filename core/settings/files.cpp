#include "core/settings/files.h"

#include "core/text/parse.h"

namespace photorque {

namespace fs = std::filesystem;

fs::path existing_file(const Settings& settings, std::string_view key, const fs::path& folder) {
  return existing_file(settings, key, folder, settings.text(key));
}

fs::path existing_file(const Settings& settings, std::string_view key, const fs::path& folder,
                       const std::string& name) {
  fs::path path = folder / name;
  std::error_code unreadable;
  if (fs::exists(path, unreadable) && !fs::is_directory(path, unreadable)) return path;
  std::set<std::string> present;
  fs::path parent = path.parent_path();
  if (parent.empty()) parent = ".";
  for (fs::directory_iterator it(parent, unreadable), end; !unreadable && it != end;
       it.increment(unreadable)) {
    present.insert(it->path().filename().string());
  }
  const std::string similar = nearest(path.filename().string(), present);
  throw settings.error(key, in_quotes(name),
                       std::string("an existing file, relative to the ") +
                           (folder.empty() ? "working directory" : "folder of the experiment") +
                           (similar.empty() ? "" : ", perhaps " + in_quotes(similar)));
}

}  // namespace photorque
