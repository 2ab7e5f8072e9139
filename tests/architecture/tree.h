// The source tree as the tests of the architecture see it: its folders, rooms and texts.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace photorque::tree {

namespace fs = std::filesystem;

inline const fs::path root = PHOTORQUE_SOURCE_DIR;

// Folders of sources, as ARCHITECTURE.md's first column names them.
inline const std::vector<std::string> top_folders = {
    "core",     "raytrace",  "sources",   "receivers", "photovoltaics", "images",
    "attitude", "inference", "diagnosis", "scenes",    "tools",         "python"};

inline bool is_source(const fs::path& file) {
  return file.extension() == ".h" || file.extension() == ".cpp";
}

// The sources of a folder and of all rooms below it.
inline std::vector<fs::path> sources_of(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    if (is_source(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// The sources of all top folders.
inline std::vector<fs::path> all_sources() {
  std::vector<fs::path> files;
  for (const std::string& folder : top_folders) {
    for (const fs::path& file : sources_of(folder)) files.push_back(file);
  }
  return files;
}

// The room a file lies in, such as "raytrace/tracing".
inline std::string room_of(const fs::path& file) {
  return fs::relative(file.parent_path(), root).generic_string();
}

// Whether `room` is `place` or lies below it.
inline bool lies_in(const std::string& room, const std::string& place) {
  return room == place || room.starts_with(place + "/");
}

inline std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline std::string without_comments(const std::string& text) {
  static const std::regex comment(R"(//[^\n]*)");
  return std::regex_replace(text, comment, "");
}

// The comments alone, one after the other, with the line breaks between them as spaces.
inline std::string comments_of(const fs::path& file) {
  static const std::regex comment(R"((^|\n|\s)//+([^\n]*))");
  const std::string text = text_of(file);
  std::string all;
  for (std::sregex_iterator it(text.begin(), text.end(), comment), end; it != end; ++it) {
    all += (*it)[2].str();
  }
  return all;
}

// The text without comments and string literals, so that prose does not count as code.
inline std::string code_of(const fs::path& file) {
  static const std::regex noise(R"(//[^\n]*|/\*[^]*?\*/|"(\\.|[^"\\\n])*")");
  return std::regex_replace(text_of(file), noise, " ");
}

// The words of a photorque_kinds() list in a folder's CMakeLists.txt, such as "lamps/led", in
// order.
inline std::vector<std::string> kinds_of(const std::string& folder) {
  static const std::regex list(R"(photorque_kinds\(\w+ \w+ \S+([^)]*)\))");
  static const std::regex word(R"([a-z_0-9/]+)");
  const std::string text = text_of(root / folder / "CMakeLists.txt");
  std::smatch found;
  std::vector<std::string> words;
  if (!std::regex_search(text, found, list)) return words;
  const std::string inside = found[1];
  for (std::sregex_iterator it(inside.begin(), inside.end(), word), end; it != end; ++it) {
    words.push_back(it->str());
  }
  return words;
}

}  // namespace photorque::tree
