// The rules of ARCHITECTURE.md, held against the sources.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace {

namespace fs = std::filesystem;

const fs::path root = PHOTORQUE_SOURCE_DIR;

// Which folders each folder may include, besides itself: the drawing in ARCHITECTURE.md.
const std::map<std::string, std::set<std::string>> allowed = {
    {"core", {}},
    {"raytrace", {"core"}},
    {"sources", {"core", "raytrace"}},
    {"receivers", {"core", "raytrace"}},
    {"images", {"core"}},
    {"attitude", {"core"}},
    {"diagnosis", {"core", "attitude"}},
    {"scenes", {"core", "raytrace", "sources", "receivers", "attitude"}},
    {"tools",
     {"core", "raytrace", "sources", "receivers", "images", "attitude", "diagnosis", "scenes"}},
};

// Headers of a library and the one folder that may include them.
const std::vector<std::pair<std::string, std::string>> only_place = {
    {"tbb/", "core"},
    {"xxhash.h", "core"},
    {"embree", "raytrace"},
    {"toml++", "scenes"},
    {"tiny_gltf", "scenes"},
    {"draco/", "scenes"},
    {"meshoptimizer", "scenes"},
    {"OpenImageIO/", "images"},
    {"cairo", "images"},
    {"CLI/", "tools"},
    {"zlib.h", "attitude"},
};

struct Include {
  fs::path file;
  std::string header;
  bool quoted;
};

std::vector<fs::path> sources_of(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(root / folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".h" || extension == ".cpp") files.push_back(entry.path());
  }
  return files;
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<Include> includes_of(const std::string& folder) {
  static const std::regex pattern(R"(#include\s+([<"])([^>"]+)[>"])");
  std::vector<Include> all;
  for (const fs::path& file : sources_of(folder)) {
    const std::string text = text_of(file);
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

TEST(House, EveryFolderHasSources) {
  for (const auto& [folder, unused] : allowed) EXPECT_GE(sources_of(folder).size(), 5u) << folder;
}

TEST(House, FoldersIncludeOnlyWhatStandsBelowThem) {
  size_t seen = 0;
  for (const auto& [folder, may_use] : allowed) {
    for (const Include& include : includes_of(folder)) {
      const std::string from = include.header.substr(0, include.header.find('/'));
      if (!include.quoted || !allowed.contains(from)) continue;
      ++seen;
      EXPECT_TRUE(from == folder || may_use.contains(from))
          << include.file << " includes " << include.header;
    }
  }
  EXPECT_GT(seen, 100u);
}

TEST(House, QuotedIncludesNameTheirFolder) {
  for (const auto& [folder, unused] : allowed) {
    for (const Include& include : includes_of(folder)) {
      if (!include.quoted || include.header.ends_with(".inc")) continue;
      EXPECT_TRUE(allowed.contains(include.header.substr(0, include.header.find('/'))))
          << include.file << " includes " << include.header;
    }
  }
}

TEST(House, EveryLibraryHasOnePlace) {
  for (const auto& [library, place] : only_place) {
    size_t in_place = 0;
    for (const auto& [folder, unused] : allowed) {
      for (const Include& include : includes_of(folder)) {
        if (include.quoted || !include.header.starts_with(library)) continue;
        EXPECT_EQ(folder, place) << include.file << " includes " << include.header;
        ++in_place;
      }
    }
    EXPECT_GT(in_place, 0u) << library << " is not used any more";
  }
}

TEST(House, OnlyTheSeamKnowsTheVersionOfEmbree) {
  for (const Include& include : includes_of("raytrace")) {
    if (!include.header.starts_with("embree")) continue;
    EXPECT_EQ(include.file.filename(), "embree_seam.h");
  }
}

TEST(House, LibrariesNeitherPrintNorExit) {
  static const std::regex talk(
      R"(\b(printf|fprintf|puts|fputs|std::cout|std::cerr|std::clog|exit|abort|quick_exit)\b\s*(\(|<<))");
  for (const auto& [folder, unused] : allowed) {
    if (folder == "tools") continue;
    for (const fs::path& file : sources_of(folder)) {
      const std::string code = code_of(file);
      std::smatch match;
      EXPECT_FALSE(std::regex_search(code, match, talk)) << file << ": " << match.str();
    }
  }
}

TEST(House, OnlyTheTwoExceptionsAreThrown) {
  static const std::regex thrown(R"(\bthrow\s+([A-Za-z_:]+))");
  // What begins with a small letter is a function or a variable that makes one of the two.
  for (const auto& [folder, unused] : allowed) {
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

TEST(House, NoGlobalVariables) {
  // A mutable namespace-scope or static object: `static T x` that is neither const nor constexpr.
  static const std::regex mutable_static(
      R"(\n\s*(static|thread_local)\s+(?!const|constexpr|inline|void|bool operator)[A-Za-z_:<>, \*&]+\s+[a-z_]+\s*(=|;|\{))");
  for (const auto& [folder, unused] : allowed) {
    for (const fs::path& file : sources_of(folder)) {
      const std::string code = code_of(file);
      std::smatch match;
      EXPECT_FALSE(std::regex_search(code, match, mutable_static)) << file << ": " << match.str();
    }
  }
}

// Two classes of one name in one program are undefined behaviour that linkers do not report.
TEST(House, TypesOfHeadersHaveDistinctNames) {
  static const std::regex type(R"(\n(struct|class|enum class) ([A-Z]\w+)\b(?!::)[^;\n]*\{)");
  std::map<std::string, fs::path> first;
  for (const auto& [folder, unused] : allowed) {
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

TEST(House, RandomnessComesFromCore) {
  static const std::regex other(R"(\b(std::mt19937|std::random_device|rand\s*\(|drand48))");
  for (const auto& [folder, unused] : allowed) {
    for (const fs::path& file : sources_of(folder)) {
      EXPECT_FALSE(std::regex_search(code_of(file), other)) << file;
    }
  }
}

TEST(House, InterfacesHaveAtMostThreeVirtualFunctions) {
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
TEST(House, EveryKindIsListedOnce) {
  static const std::regex kind_function(
      R"((?:Kind|Verb)\s+([a-z0-9_]+)_(?:kind|verb)\s*\(\s*\)\s*\{)");
  std::set<std::string> functions;
  for (const auto& [folder, unused] : allowed) {
    const std::string list = text_of(root / folder / "CMakeLists.txt");
    for (const fs::path& file : sources_of(folder)) {
      const std::string code = code_of(file);
      std::smatch match;
      if (file.extension() != ".cpp" || !std::regex_search(code, match, kind_function)) continue;
      EXPECT_EQ(match[1].str(), file.stem().string());
      const std::string name = match.str();
      EXPECT_TRUE(functions.insert(name.substr(name.find(' ') + 1)).second) << file;
      EXPECT_TRUE(std::regex_search(list, std::regex("\\b" + match[1].str() + "\\b"))) << file;
    }
  }
}

}  // namespace
