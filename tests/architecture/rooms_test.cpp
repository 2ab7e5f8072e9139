// The rules of ARCHITECTURE.md, held against the sources.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace {

namespace fs = std::filesystem;

const fs::path root = PHOTORQUE_SOURCE_DIR;

// Headers of a library and the one folder that may include them.
const std::vector<std::pair<std::string, std::string>> only_place = {
    {"tbb/", "core"},
    {"xxhash.h", "core"},
    {"embree", "raytrace/tracing"},
    {"toml++", "scenes/experiment"},
    {"tiny_gltf", "scenes/gltf/file"},
    {"draco/", "scenes/gltf/file"},
    {"meshoptimizer", "scenes/gltf/file"},
    {"OpenImageIO/", "images/writers"},
    {"cairo", "images/canvas"},
    {"CLI/", "tools"},
    {"zlib.h", "attitude/recordings"},
    {"pugixml", "sources/photometry"},
};

// Folders of sources, as ARCHITECTURE.md's first column names them.
const std::vector<std::string> top_folders = {"core",          "raytrace", "sources",  "receivers",
                                              "photovoltaics", "images",   "attitude", "inference",
                                              "diagnosis",     "scenes",   "tools"};

struct Include {
  fs::path file;
  std::string header;
  bool quoted;
};

bool is_source(const fs::path& file) {
  return file.extension() == ".h" || file.extension() == ".cpp";
}

// The sources of a folder and of all rooms below it.
std::vector<fs::path> sources_of(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    if (is_source(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// The room a file lies in, such as "raytrace/tracing".
std::string room_of(const fs::path& file) {
  return fs::relative(file.parent_path(), root).generic_string();
}

// Whether `room` is `place` or lies below it.
bool lies_in(const std::string& room, const std::string& place) {
  return room == place || room.starts_with(place + "/");
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string without_comments(const std::string& text) {
  static const std::regex comment(R"(//[^\n]*)");
  return std::regex_replace(text, comment, "");
}

std::vector<Include> includes_of(const std::string& folder) {
  static const std::regex pattern(R"(#include\s+([<"])([^>"]+)[>"])");
  std::vector<Include> all;
  for (const fs::path& file : sources_of(folder)) {
    const std::string text = without_comments(text_of(file));
    for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) {
      all.push_back({file, (*it)[2], (*it)[1] == "\""});
    }
  }
  return all;
}

// The text without comments and string literals, so that prose does not count as code.
std::string code_of(const fs::path& file) {
  static const std::regex noise(R"(//[^\n]*|/\*[^]*?\*/|"(\\.|[^"\\\n])*")");
  return std::regex_replace(text_of(file), noise, " ");
}

// What ARCHITECTURE.md says: each row `| room | purpose | what it includes |` of its tables whose
// first cell is a path in backquotes. Rooms of core are open to all and are not listed.
std::map<std::string, std::set<std::string>> rooms_of_the_page() {
  static const std::regex row(R"(\n\| `([a-z/_0-9]+)` \|[^|\n]*\|([^|\n]*)\|)");
  static const std::regex word(R"([a-z_0-9]+(/[a-z_0-9]+)*)");
  std::map<std::string, std::set<std::string>> rooms;
  const std::string page = text_of(root / "ARCHITECTURE.md");
  for (std::sregex_iterator it(page.begin(), page.end(), row), end; it != end; ++it) {
    const std::string cell = (*it)[2];
    std::set<std::string>& includes = rooms[(*it)[1]];
    for (std::sregex_iterator w(cell.begin(), cell.end(), word); w != end; ++w) {
      includes.insert(w->str());
    }
  }
  return rooms;
}

// What the sources say: for every room with sources, the rooms that it includes.
std::map<std::string, std::set<std::string>> rooms_of_the_sources() {
  std::map<std::string, std::set<std::string>> rooms;
  for (const std::string& folder : top_folders) {
    for (const fs::path& file : sources_of(folder)) rooms[room_of(file)];
    for (const Include& include : includes_of(folder)) {
      if (!include.quoted) continue;
      const std::string from = room_of(include.file);
      const std::string to = fs::path(include.header).parent_path().generic_string();
      if (to != from) rooms[from].insert(to);
    }
  }
  return rooms;
}

// Neither an include that the page does not draw, nor an arrow on the page that nobody uses.
TEST(Rooms, ThePageDrawsEveryIncludeAndNoOther) {
  const auto page = rooms_of_the_page();
  auto sources = rooms_of_the_sources();
  ASSERT_GT(sources.size(), 40u);
  for (auto& [room, includes] : sources) {
    if (!lies_in(room, "core")) {
      std::erase_if(includes, [](const std::string& to) { return lies_in(to, "core"); });
    }
    ASSERT_TRUE(page.contains(room)) << "ARCHITECTURE.md has no row for " << room;
    EXPECT_EQ(page.at(room), includes) << "the includes of " << room << " in ARCHITECTURE.md";
  }
  for (const auto& [room, unused] : page) {
    EXPECT_TRUE(sources.contains(room)) << room << " of ARCHITECTURE.md has no sources";
  }
}

TEST(Rooms, IncludesNeverRunInACircle) {
  auto left = rooms_of_the_sources();
  while (!left.empty()) {
    const auto lowest = std::find_if(left.begin(), left.end(), [&](const auto& room) {
      return std::none_of(room.second.begin(), room.second.end(),
                          [&](const std::string& to) { return left.contains(to); });
    });
    if (lowest == left.end()) {
      std::string circle;
      for (const auto& [room, unused] : left) circle += " " + room;
      FAIL() << "a circle among" << circle;
    }
    left.erase(lowest);
  }
}

TEST(Rooms, HaveAtMost25FilesWhoseNamesDoNotRepeatTheRoom) {
  std::map<std::string, size_t> files;
  for (const std::string& folder : top_folders) {
    for (const fs::path& file : sources_of(folder)) {
      ++files[room_of(file)];
      const std::string own = file.parent_path().filename().string();
      // A kind is named as users write it.
      const bool is_kind =
          text_of(file).find(file.stem().string() + "_kind()") != std::string::npos;
      EXPECT_TRUE(is_kind || !file.stem().string().starts_with(own + "_")) << file;
    }
  }
  for (const auto& [room, count] : files) EXPECT_LE(count, 25u) << room;
}

TEST(Rooms, QuotedIncludesArePathsFromTheTop) {
  for (const std::string& folder : top_folders) {
    for (const Include& include : includes_of(folder)) {
      if (!include.quoted || include.header == "core/build_info.h") continue;
      EXPECT_TRUE(fs::exists(root / include.header))
          << include.file << " includes " << include.header;
    }
  }
}

TEST(Rooms, EveryLibraryHasOnePlace) {
  for (const auto& [library, place] : only_place) {
    size_t in_place = 0;
    for (const std::string& folder : top_folders) {
      for (const Include& include : includes_of(folder)) {
        if (include.quoted || !include.header.starts_with(library)) continue;
        EXPECT_TRUE(lies_in(room_of(include.file), place))
            << include.file << " includes " << include.header;
        ++in_place;
      }
    }
    EXPECT_GT(in_place, 0u) << library << " is not used any more";
  }
}

TEST(Rooms, OnlyTheSeamKnowsTheVersionOfEmbree) {
  for (const Include& include : includes_of("raytrace")) {
    if (!include.header.starts_with("embree")) continue;
    EXPECT_EQ(include.file.filename(), "embree_seam.h");
  }
}

TEST(Rooms, LibrariesNeitherPrintNorExit) {
  static const std::regex talk(
      R"(\b(printf|fprintf|puts|fputs|std::cout|std::cerr|std::clog|exit|abort|quick_exit)\b\s*(\(|<<))");
  for (const std::string& folder : top_folders) {
    if (folder == "tools") continue;
    for (const fs::path& file : sources_of(folder)) {
      const std::string code = code_of(file);
      std::smatch match;
      EXPECT_FALSE(std::regex_search(code, match, talk)) << file << ": " << match.str();
    }
  }
}

TEST(Rooms, OnlyTheTwoExceptionsAreThrown) {
  static const std::regex thrown(R"(\bthrow\s+([A-Za-z_:]+))");
  // What begins with a small letter is a function or a variable that makes one of the two.
  for (const std::string& folder : top_folders) {
    for (const fs::path& file : sources_of(folder)) {
      const std::string code = code_of(file);
      for (std::sregex_iterator it(code.begin(), code.end(), thrown), end; it != end; ++it) {
        const std::string name = (*it)[1];
        if (name == "InputError" || name == "NumericalError") continue;
        EXPECT_FALSE(name.starts_with("std::") || std::isupper(static_cast<unsigned char>(name[0])))
            << file << " throws " << name;
      }
    }
  }
}

TEST(Rooms, NoGlobalVariables) {
  // A mutable namespace-scope or static object: `static T x` that is neither const nor constexpr.
  static const std::regex mutable_static(
      R"(\n\s*(static|thread_local)\s+(?!const|constexpr|inline|void|bool operator)[A-Za-z_:<>, \*&]+\s+[a-z_]+\s*(=|;|\{))");
  for (const std::string& folder : top_folders) {
    for (const fs::path& file : sources_of(folder)) {
      const std::string code = code_of(file);
      std::smatch match;
      EXPECT_FALSE(std::regex_search(code, match, mutable_static)) << file << ": " << match.str();
    }
  }
}

// Two classes of one name in one program are undefined behaviour that linkers do not report.
TEST(Rooms, TypesOfHeadersHaveDistinctNames) {
  static const std::regex type(R"(\n(struct|class|enum class) ([A-Z]\w+)\b(?!::)[^;\n]*\{)");
  std::map<std::string, fs::path> first;
  for (const std::string& folder : top_folders) {
    for (const fs::path& file : sources_of(folder)) {
      if (file.extension() != ".h") continue;
      const std::string code = code_of(file);
      for (std::sregex_iterator it(code.begin(), code.end(), type), end; it != end; ++it) {
        const auto [place, is_new] = first.try_emplace((*it)[2], file);
        EXPECT_TRUE(is_new || place->second == file)
            << (*it)[2] << " in " << place->second << " and " << file;
      }
    }
  }
  EXPECT_GT(first.size(), 100u);
}

TEST(Rooms, RandomnessComesFromCore) {
  static const std::regex other(R"(\b(std::mt19937|std::random_device|rand\s*\(|drand48))");
  for (const std::string& folder : top_folders) {
    for (const fs::path& file : sources_of(folder)) {
      EXPECT_FALSE(std::regex_search(code_of(file), other)) << file;
    }
  }
}

TEST(Rooms, InterfacesHaveAtMostThreeVirtualFunctions) {
  static const std::regex pure(R"(\)\s*(const\s*)?=\s*0\s*;)");
  for (const char* header : {"raytrace/emitter.h", "raytrace/receiver.h", "images/writers/writer.h",
                             "attitude/model/disturbance.h"}) {
    const std::string code = code_of(root / header);
    const auto count =
        std::distance(std::sregex_iterator(code.begin(), code.end(), pure), std::sregex_iterator());
    EXPECT_GE(count, 1) << header;
    EXPECT_LE(count, 3) << header;
  }
}

// One word in the folder's list is one file, and every kind's file is in the list. No two kinds
// share a function: linkers do not see return types and would quietly take either.
TEST(Rooms, EveryKindIsListedOnce) {
  static const std::regex kind_function(
      R"((?:Kind|Verb)\s+([a-z0-9_]+)_(?:kind|verb)\s*\(\s*\)\s*\{)");
  std::set<std::string> functions;
  for (const std::string& folder : top_folders) {
    const std::string list = text_of(root / folder / "CMakeLists.txt");
    for (const fs::path& file : sources_of(folder)) {
      const std::string code = code_of(file);
      std::smatch match;
      if (file.extension() != ".cpp" || !std::regex_search(code, match, kind_function)) continue;
      EXPECT_EQ(match[1].str(), file.stem().string());
      const std::string name = match.str();
      EXPECT_TRUE(functions.insert(name.substr(name.find(' ') + 1)).second) << file;
      const std::string word =
          fs::relative(file, root / folder).replace_extension().generic_string();
      EXPECT_TRUE(std::regex_search(list, std::regex("[\\s]" + word + "[\\s)]"))) << file;
    }
  }
}

}  // namespace
