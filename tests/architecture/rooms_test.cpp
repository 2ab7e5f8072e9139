// The rules of ARCHITECTURE.md, compared with the sources.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/architecture/tree.h"

#include <map>
#include <regex>
#include <set>

namespace {

using namespace photorque::tree;

// Headers of a library and the one folder that may include them; of pugixml two that read and one
// that writes.
const std::multimap<std::string, std::string> only_place = {
    {"tbb/", "core"},
    {"xxhash.h", "core"},
    {"embree", "raytrace/tracing"},
    {"toml++", "scenes/experiment"},
    {"tiny_gltf", "scenes/gltf/file"},
    {"draco/", "scenes/gltf/file"},
    {"meshoptimizer", "scenes/gltf/file"},
    {"OpenImageIO/", "images/writers"},
    {"tiffio.h", "images/writers"},
    {"cairo", "images/drawing"},
    {"CLI/", "tools"},
    {"zlib.h", "attitude/recordings"},
    {"zlib.h", "images/writers"},
    {"pugixml", "sources/photometry"},
    {"pugixml", "attitude/recordings"},
    {"pugixml", "tools/verbs/attitude"},
    {"minizip/", "tools/verbs/attitude"},
    {"pybind11", "python"},
    {"hdf5.h", "images/writers"},
    {"sqlite3.h", "tools/sweeps"},
    {"nlopt", "tools/sweeps"},
};

struct Include {
  fs::path file;
  std::string header;
  bool quoted;
};

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

// Rows `| `room` | purpose |` of ARCHITECTURE.md, whose first cell is a path in backquotes.
std::set<std::string> rooms_of_the_page() {
  static const std::regex row(R"(\n\| `([a-z/_0-9]+)` \|[^|\n]+\|)");
  std::set<std::string> rooms;
  const std::string page = text_of(root / "ARCHITECTURE.md");
  for (std::sregex_iterator it(page.begin(), page.end(), row), end; it != end; ++it) {
    rooms.insert((*it)[1]);
  }
  return rooms;
}

// The rooms of the sources: for every room with sources, the rooms that it includes.
std::map<std::string, std::set<std::string>> rooms_of_the_sources() {
  std::map<std::string, std::set<std::string>> rooms;
  for (const std::string& folder : top_folders) {
    for (const fs::path& file : sources_of(folder)) rooms[room_of(file)];
    for (const Include& include : includes_of(folder)) {
      // The precompiled header stands before every file; no file includes it.
      if (!include.quoted || include.file.filename() == "precompiled.h") continue;
      const std::string from = room_of(include.file);
      const std::string to = fs::path(include.header).parent_path().generic_string();
      if (to != from) rooms[from].insert(to);
    }
  }
  return rooms;
}

TEST(Rooms, EveryRoomHasARowOnThePageAndNoOther) {
  std::set<std::string> rooms;
  for (const auto& [room, unused] : rooms_of_the_sources()) rooms.insert(room);
  ASSERT_GT(rooms.size(), 40u);
  EXPECT_EQ(rooms_of_the_page(), rooms);
}

// The drawing's arrows `A, B ──> C`, each from every folder on its left to every one on its right.
// A line that begins with a branch continues the first folders of the drawing.
std::set<std::pair<std::string, std::string>> arrows_of_the_page() {
  static const std::regex name(R"([a-z]+)");
  const std::string page = text_of(root / "ARCHITECTURE.md");
  const size_t begin = page.find("```\n") + 4;
  std::istringstream drawing(page.substr(begin, page.find("\n```", begin) - begin));
  std::set<std::pair<std::string, std::string>> arrows;
  std::set<std::string> first;
  for (std::string line; std::getline(drawing, line);) {
    const bool is_branch = !line.empty() && (line[0] < 'a' || line[0] > 'z');
    std::set<std::string> left = is_branch ? first : std::set<std::string>{};
    for (size_t at = 0; at != std::string::npos;) {
      const size_t next = line.find("──>", at);
      const std::string segment = line.substr(at, next - at);
      std::set<std::string> names;
      for (std::sregex_iterator it(segment.begin(), segment.end(), name), end; it != end; ++it) {
        names.insert(it->str());
      }
      if (first.empty()) first = names;
      for (const std::string& from : left) {
        for (const std::string& to : names) {
          if (from != to) arrows.emplace(from, to);
        }
      }
      if (!names.empty()) left = names;
      at = next == std::string::npos ? next : next + std::string("──>").size();
    }
  }
  return arrows;
}

TEST(Rooms, TheDrawingShowsEveryIncludeAndNoOther) {
  const auto top = [](const std::string& room) { return room.substr(0, room.find('/')); };
  std::set<std::pair<std::string, std::string>> includes;
  for (const auto& [room, others] : rooms_of_the_sources()) {
    for (const std::string& other : others) {
      if (top(other) != top(room)) includes.emplace(top(room), top(other));
    }
  }
  auto reach = arrows_of_the_page();
  EXPECT_GE(reach.size(), 10u);
  for (const auto& [from, to] : reach) {
    if (to == "core") continue;  // open to all
    EXPECT_TRUE(includes.contains({from, to})) << "nothing in " << from << " includes " << to;
  }
  for (size_t before = 0; before != reach.size();) {
    before = reach.size();
    const auto known = reach;
    for (const auto& [from, over] : known) {
      for (const auto& [start, to] : known) {
        if (start == over) reach.emplace(from, to);
      }
    }
  }
  for (const auto& [from, to] : includes) {
    if (to == "core") continue;
    EXPECT_TRUE(reach.contains({from, to})) << from << " includes " << to << " against the drawing";
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

TEST(Rooms, HaveAtMost30FilesWithNamesThatDoNotRepeatTheFolder) {
  std::map<std::string, size_t> files;
  for (const fs::path& file : all_sources()) {
    ++files[room_of(file)];
    const std::string own = file.parent_path().filename().string();
    // A kind is named as users write it.
    const bool is_kind =
        text_of(file).find("s::" + file.stem().string() + " {") != std::string::npos;
    EXPECT_TRUE(is_kind || !file.stem().string().starts_with(own + "_")) << file;
  }
  for (const auto& [room, count] : files) EXPECT_LE(count, 30u) << room;
}

TEST(Rooms, EveryLibraryHasOnePlace) {
  std::set<std::pair<std::string, std::string>> used;
  for (const std::string& folder : top_folders) {
    for (const Include& include : includes_of(folder)) {
      if (include.quoted) continue;
      bool is_listed = false, is_in_place = false;
      for (const auto& [library, place] : only_place) {
        if (!include.header.starts_with(library)) continue;
        is_listed = true;
        if (!lies_in(room_of(include.file), place)) continue;
        is_in_place = true;
        used.emplace(library, place);
      }
      EXPECT_TRUE(is_in_place || !is_listed) << include.file << " includes " << include.header;
    }
  }
  for (const auto& [library, place] : only_place) {
    EXPECT_TRUE(used.contains({library, place})) << library << " is not used in " << place;
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
  // A name with a small first letter is a function or a variable that makes one of the two.
  for (const fs::path& file : all_sources()) {
    const std::string code = code_of(file);
    for (std::sregex_iterator it(code.begin(), code.end(), thrown), end; it != end; ++it) {
      const std::string name = (*it)[1];
      if (name == "InputError" || name == "NumericalError") continue;
      if (name == "BeyondTable") continue;  // a NumericalError
      EXPECT_FALSE(name.starts_with("std::") || std::isupper(static_cast<unsigned char>(name[0])))
          << file << " throws " << name;
    }
  }
}

TEST(Rooms, NoGlobalVariables) {
  // A mutable namespace-scope or static object: `static T x` that is neither const nor constexpr.
  static const std::regex mutable_static(
      R"(\n\s*(static|thread_local)\s+(?!const|constexpr|inline|void|bool operator)[A-Za-z_:<>, \*&]+\s+[a-z_]+\s*(=|;|\{))");
  for (const fs::path& file : all_sources()) {
    const std::string code = code_of(file);
    std::smatch match;
    EXPECT_FALSE(std::regex_search(code, match, mutable_static)) << file << ": " << match.str();
  }
}

// Two classes of one name in one program are undefined behaviour that linkers do not report.
TEST(Rooms, TypesOfHeadersHaveDistinctNames) {
  static const std::regex type(R"(\n(struct|class|enum class) ([A-Z]\w+)\b(?!::)[^;\n]*\{)");
  static const std::regex space(R"(\nnamespace ([a-z:]+) \{)");
  std::map<std::string, fs::path> first;
  for (const fs::path& file : all_sources()) {
    if (file.extension() != ".h") continue;
    const std::string code = code_of(file);
    std::smatch in;
    const std::string scope = std::regex_search(code, in, space) ? in[1].str() + "::" : "";
    for (std::sregex_iterator it(code.begin(), code.end(), type), end; it != end; ++it) {
      const auto [place, is_new] = first.try_emplace(scope + (*it)[2].str(), file);
      EXPECT_TRUE(is_new || place->second == file)
          << scope << (*it)[2] << " in " << place->second << " and " << file;
    }
  }
  EXPECT_GT(first.size(), 100u);
}

TEST(Rooms, RandomnessComesFromCore) {
  static const std::regex other(R"(\b(std::mt19937|std::random_device|rand\s*\(|drand48))");
  for (const fs::path& file : all_sources()) {
    EXPECT_FALSE(std::regex_search(code_of(file), other)) << file;
  }
}

// Where the block that opens at or after `from` closes.
size_t end_of_block(const std::string& code, size_t from) {
  int depth = 0;
  for (size_t i = code.find('{', from); i < code.size(); ++i) {
    if (code[i] == '{') ++depth;
    if (code[i] == '}' && --depth == 0) return i;
  }
  return code.size();
}

struct Interface {
  std::string header;
  std::vector<std::string> functions;  // virtual ones, destructors aside, in order
};

// Every class of the sources that declares a virtual function.
std::map<std::string, Interface> interfaces_of_the_sources() {
  static const std::regex type(R"(\b(?:class|struct)\s+([A-Z]\w*)\b(?!::)[^;{}()]*\{)");
  static const std::regex function(R"(\bvirtual\s+(?!~)[^;{}]*?\b(\w+)\s*\()");
  std::map<std::string, Interface> interfaces;
  for (const fs::path& file : all_sources()) {
    const std::string code = code_of(file);
    for (std::sregex_iterator it(code.begin(), code.end(), type), end; it != end; ++it) {
      const auto begin = static_cast<size_t>(it->position());
      const std::string body = code.substr(begin, end_of_block(code, begin) - begin);
      Interface found{fs::relative(file, root).generic_string(), {}};
      for (std::sregex_iterator f(body.begin(), body.end(), function); f != end; ++f) {
        found.functions.push_back((*f)[1]);
      }
      if (!found.functions.empty()) interfaces.emplace((*it)[1], found);
    }
  }
  return interfaces;
}

// The page's rows `| `Name` | function, function | `header` |`.
std::map<std::string, Interface> interfaces_of_the_page() {
  static const std::regex row(R"(\n\| `([A-Z]\w*)` \| ([^|\n]*) \| `([a-z/_0-9.]+)`)");
  static const std::regex name(R"(`(\w+)`)");
  std::map<std::string, Interface> interfaces;
  const std::string page = text_of(root / "ARCHITECTURE.md");
  for (std::sregex_iterator it(page.begin(), page.end(), row), end; it != end; ++it) {
    const std::string cell = (*it)[2];
    Interface& listed = interfaces[(*it)[1]];
    listed.header = (*it)[3];
    for (std::sregex_iterator f(cell.begin(), cell.end(), name); f != end; ++f) {
      listed.functions.push_back((*f)[1]);
    }
  }
  return interfaces;
}

TEST(Rooms, InterfacesAreThoseOfThePageWithAtMostThreeVirtualFunctions) {
  const auto page = interfaces_of_the_page(), sources = interfaces_of_the_sources();
  EXPECT_GE(sources.size(), 6u);
  for (const auto& [name, found] : sources) {
    EXPECT_LE(found.functions.size(), 3u) << name << " in " << found.header;
    ASSERT_TRUE(page.contains(name)) << "ARCHITECTURE.md has no row for the interface " << name;
    EXPECT_EQ(page.at(name).header, found.header) << name;
    EXPECT_EQ(page.at(name).functions, found.functions) << name;
  }
  for (const auto& [name, listed] : page) {
    EXPECT_TRUE(sources.contains(name)) << name << " of ARCHITECTURE.md has no virtual function";
  }
}

// No value of settings is multiplied by a factor of units.
TEST(Rooms, UnitsOfKeysAreConvertedInSettingsAlone) {
  static const std::regex converted(
      R"(\b(number|number_or|numbers|uncertain|vector3|get|get_or)\s*\([^;]*\)\s*[*/]\s*)"
      R"((1e-?\d|0\.0*1\b|10+(\.0)?\b|3600|60(\.0)?\b|degree_rad|arcsecond_rad|pi\b))");
  for (const fs::path& file : all_sources()) {
    if (lies_in(room_of(file), "core/settings")) continue;
    const std::string code = code_of(file);
    std::smatch match;
    EXPECT_FALSE(std::regex_search(code, match, converted)) << file << ": " << match.str();
  }
}

// One word in the folder's list is one file, and every kind's file is in the list. No two kinds
// share a namespace: linkers do not see return types and would quietly take either function.
TEST(Rooms, EveryKindIsListedOnce) {
  static const std::regex kind_namespace(
      R"(namespace (?:photorque::)?((?:kinds|verbs)::([a-z0-9_]+)) \{)");
  std::set<std::string> names;
  for (const std::string& folder : top_folders) {
    const std::string list = text_of(root / folder / "CMakeLists.txt");
    for (const fs::path& file : sources_of(folder)) {
      const std::string code = code_of(file);
      std::smatch match;
      if (file.extension() != ".cpp" || !std::regex_search(code, match, kind_namespace)) continue;
      EXPECT_EQ(match[2].str(), file.stem().string());
      EXPECT_TRUE(names.insert(match[1]).second) << file;
      const std::string word =
          fs::relative(file, root / folder).replace_extension().generic_string();
      EXPECT_TRUE(std::regex_search(list, std::regex("[\\s]" + word + "[\\s)]"))) << file;
    }
  }
  EXPECT_GT(names.size(), 60u);
}

// Only its own file names a kind of disturbance: others use its properties.

// Files outside a kind's own that hold its name in quotes, and why.
const std::map<std::string, std::set<std::string>> allowed = {
    // A gyro has a bias, and senses the turning Earth, whether the torques are modelled or not.
    {"attitude/filtering/motion_model.cpp", {"earth_rotation", "gyro_bias"}},
    // `balance` measures this kind.
    {"attitude/studies/balance.cpp", {"static_unbalance"}},
    // A chart and a key of diagnosis.json that had this name before the kind.
    {"tools/pages/charts.cpp", {"empirical_torque"}},
    {"diagnosis/json.cpp", {"empirical_torque"}},
    // Written into improved.toml and into a first experiment.
    {"diagnosis/improved.cpp", {"empirical_torque"}},
    {"diagnosis/guess/motion.cpp", {"sliding_spring"}},
    // Motion and light share this kind.
    {"diagnosis/light/together.cpp", {"gravity_tilt"}},
    // Kinds of the same form, named by one of the two.
    {"attitude/disturbances/bearing/turbine_torque.cpp", {"room_draft"}},
    {"attitude/disturbances/mass/battery_discharge.cpp", {"mass_shift", "static_unbalance"}},
    // A key of that table's name.
    {"attitude/disturbances/fields/helmholtz_cage.cpp", {"orbit"}},
    // `new` writes these kinds.
    {"tools/verbs/new_experiment.cpp", {"bearing_drag", "static_unbalance"}},
    // The orbit takes the direction of the Sun, and the planet's light that of the orbit; drag
    // needs an orbit.
    {"tools/runs/attitude_run.cpp", {"aerodynamic_drag", "orbit", "planet_light"}},
    // Light in the run is this kind; kinds with the same effect are refused.
    {"attitude/disturbances/fields/light_pressure.cpp", {"radiation_pressure"}},
    {"tools/coupling/couple.cpp", {"power_balance", "radiation_pressure"}},
    // Around a platform in orbit there is no air that cools its cells.
    {"tools/runs/array_power.cpp", {"orbit"}},
    // The trade compares ways by the disturbances that they are.
    {"tools/supply/onboard.cpp", {"battery_discharge", "tether"}},
    // A key of [environment.sun]: the path about the Sun.
    {"attitude/environment/sun.cpp", {"orbit"}},
};

// Name and own file of every kind, from the folder's list of words.
std::map<std::string, std::string> kinds_of_the_list() {
  static const std::regex word(R"(disturbances/[a-z]+/([a-z_]+)(?!\.cpp|[a-z_]))");
  std::string list = text_of(root / "attitude/CMakeLists.txt");
  list.erase(list.find("photorque_folder"));
  std::map<std::string, std::string> kinds;
  for (std::sregex_iterator it(list.begin(), list.end(), word), end; it != end; ++it) {
    kinds[(*it)[1]] = "attitude/" + it->str() + ".cpp";
  }
  return kinds;
}

TEST(KindNames, StandInTheKindsOwnFileAlone) {
  static const std::regex quoted(R"re("([a-z_]+)")re");
  const std::map<std::string, std::string> kinds = kinds_of_the_list();
  ASSERT_GT(kinds.size(), 30u);
  std::map<std::string, std::set<std::string>> found;
  for (const std::string folder : {"attitude", "diagnosis", "inference", "tools"}) {
    for (const fs::path& path : sources_of(folder)) {
      const std::string file = fs::relative(path, root).generic_string();
      if (file.starts_with("tools/benchmarks/")) continue;  // a benchmark keeps its cases
      const std::string text = without_comments(text_of(path));
      for (std::sregex_iterator it(text.begin(), text.end(), quoted), end; it != end; ++it) {
        const auto kind = kinds.find((*it)[1]);
        if (kind != kinds.end() && kind->second != file) found[file].insert(kind->first);
      }
    }
  }
  EXPECT_EQ(found, allowed);
}

}  // namespace
