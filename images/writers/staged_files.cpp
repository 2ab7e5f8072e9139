#include "images/writers/staged_files.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* list_name = "files.json";
// Files that describe all others: removed first and written last.
constexpr const char* heads[] = {"summary.json", "diagnosis.json"};

bool is_head(const std::string& name) {
  return std::ranges::find(heads, name) != std::end(heads);
}

// Lists of the files of commands, by command; empty if there is no readable list.
std::optional<Json> lists_in(const fs::path& path) {
  std::error_code failure;
  if (!fs::is_regular_file(path, failure)) return std::nullopt;
  const std::string text = read_file(path);
  if (extent_of_json(text).depth > deepest_json) return std::nullopt;
  const Json read = Json::parse(text, nullptr, false);
  // Content of another form is ignored.
  const bool known = read.is_object() && read.contains("schema") &&
                     read["schema"] == "photorque.files/1" && read.contains("commands") &&
                     read["commands"].is_object();
  return known ? std::optional<Json>(read["commands"]) : std::nullopt;
}
Json read_lists(const fs::path& path) {
  return lists_in(path).value_or(Json::object());
}

// Accepts plain file names only: a manipulated list must not refer to other folders.
std::set<std::string> listed(const Json& lists, const std::string& command) {
  std::set<std::string> names;
  const auto list = lists.find(command);
  if (list == lists.end() || !list->is_object() || !list->contains("files")) return names;
  for (const Json& name : (*list)["files"]) {
    if (!name.is_string()) continue;
    const auto& text = name.get_ref<const std::string&>();
    const bool plain = !text.empty() && text.front() != '.' && text.find('/') == std::string::npos;
    if (plain) names.insert(text);
  }
  return names;
}

// Files that one command has just written are removed from the lists of the others.
void write_lists(const fs::path& path, Json lists, const std::string& command,
                 const std::set<std::string>& names, const Provenance& provenance) {
  for (auto& [other, list] : lists.items()) {
    if (!list.is_object()) continue;
    std::set<std::string> left = listed(lists, other);
    for (const std::string& name : names) left.erase(name);
    list["files"] = left;
  }
  lists[command] = {{"files", names}, {"made_by", clean_text(provenance.one_line())}};
  const Json all = {{"schema", "photorque.files/1"}, {"commands", lists}};
  write_file_whole(path, all.dump(2) + "\n");
}

// Files that no command lists, and lists of another form, belong to the user. They are renamed if a
// result has their name.
void keep_own_files(const fs::path& folder, std::set<std::string> now) {
  const std::optional<Json> lists = lists_in(folder / list_name);
  std::set<std::string> results;
  if (lists) {
    for (const auto& [command, list] : lists->items()) results.merge(listed(*lists, command));
    results.insert(list_name);
  }
  now.insert(list_name);
  std::error_code failure;
  for (const std::string& name : now) {
    const fs::path place = folder / name;
    if (results.contains(name) || !fs::exists(fs::symlink_status(place, failure))) continue;
    fs::path kept = folder / (name + "~");
    for (int copy = 2; fs::exists(fs::symlink_status(kept, failure)); ++copy) {
      kept = folder / (name + "~" + std::to_string(copy));
    }
    fs::rename(place, kept, failure);
    if (failure) throw InputError({place.string()}, "", failure.message(), "a name for a result");
  }
}

}  // namespace

bool is_result_of(const fs::path& folder, const std::string& command, const std::string& name) {
  return listed(read_lists(folder / list_name), command).contains(name);
}

StagedFiles::StagedFiles(const fs::path& folder)
    : folder_(folder), path_(temporary_beside(folder / "results")) {
  std::error_code failure;
  for (fs::path p = fs::absolute(folder); !fs::exists(p, failure) && p.has_relative_path();
       p = p.parent_path()) {
    made_ = p;
  }
  make_folders(folder);
  // The folder must not exist yet: an existing folder or link belongs to another run.
  if (!fs::create_directory(path_, failure)) {
    throw InputError({folder.string()}, "", failure ? failure.message() : "a folder of that name",
                     "a writable folder");
  }
}

StagedFiles::~StagedFiles() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (!published_ && !made_.empty()) fs::remove_all(made_, ignored);
}

std::vector<std::string> StagedFiles::names() const {
  std::vector<std::string> names;
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_, failure)) {
    names.push_back(entry.path().filename().string());
  }
  if (failure) {
    throw InputError({folder_.string()}, "", failure.message(), "a folder that stays");
  }
  std::ranges::sort(names);
  return names;
}

void StagedFiles::move(const std::string& name) const {
  std::error_code failure;
  fs::rename(path_ / name, folder_ / name, failure);
  if (failure) {
    throw InputError({(folder_ / name).string()}, "", failure.message(),
                     "a path that can be written");
  }
}

std::vector<fs::path> StagedFiles::publish_as(const std::string& command,
                                              const Provenance& provenance) {
  const fs::path list_path = folder_ / list_name;
  const std::vector<std::string> all = names();
  const std::set<std::string> now(all.begin(), all.end());
  keep_own_files(folder_, now);
  const Json lists = read_lists(list_path);
  std::set<std::string> ever = listed(lists, command);
  ever.insert(now.begin(), now.end());
  // If the run is killed from here on, the list contains all files that may exist.
  write_lists(list_path, lists, command, ever, provenance);
  published_ = true;
  std::error_code ignored;
  for (const std::string& name : ever) {
    if (is_head(name)) fs::remove(folder_ / name, ignored);
  }
  sync_folder(folder_);
  for (const std::string& name : ever) {
    if (!now.contains(name)) fs::remove(folder_ / name, ignored);
  }
  std::vector<fs::path> places;
  for (const std::string& name : now) {
    if (!is_head(name)) move(name);
    places.push_back(folder_ / name);
  }
  write_lists(list_path, lists, command, now, provenance);
  for (const std::string& name : now) {
    if (is_head(name)) move(name);
  }
  sync_folder(folder_);
  return places;
}

}  // namespace photorque
