// What the documents say of the tree, as far as a program can check it: files, commands, kinds,
// packages and words.
#include <gtest/gtest.h>

#include "tests/architecture/tree.h"

namespace {

using namespace photorque::tree;

std::vector<fs::path> documents() {
  std::vector<fs::path> all = {root / "ARCHITECTURE.md", root / "README.md"};
  for (const auto& entry : fs::recursive_directory_iterator(root / "docs")) {
    if (entry.path().extension() == ".md") all.push_back(entry.path());
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<std::string> matches(const std::string& text, const std::regex& pattern, int group) {
  std::vector<std::string> all;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) {
    all.push_back((*it)[static_cast<size_t>(group)]);
  }
  return all;
}

// Every file and folder of the tree from the top, without what builds and runs leave there.
const std::set<std::string>& tree() {
  static const std::set<std::string> all = [] {
    std::set<std::string> paths;
    auto it = fs::recursive_directory_iterator(root);
    for (const auto end = fs::end(it); it != end; ++it) {
      const std::string name = it->path().filename().string();
      if (it.depth() == 0 &&
          (name.starts_with(".") || name.starts_with("build") || name == "out")) {
        it.disable_recursion_pending();
        continue;
      }
      paths.insert(fs::relative(it->path(), root).generic_string());
    }
    return paths;
  }();
  return all;
}

// Whether the tree has a file or folder at this path, or one whose path ends in it.
bool exists(const std::string& path) {
  if (tree().contains(path)) return true;
  return std::any_of(tree().begin(), tree().end(),
                     [&](const std::string& other) { return other.ends_with("/" + path); });
}

// Paths among the words of `text`: sources by their extension, others where they begin with a
// folder at the top of the tree. Names in capitals stand for any name, as does a star.
std::vector<std::string> paths_in(const std::string& text) {
  static const std::regex source(R"([\w./-]*\w\.(h|cpp)\b)");
  static const std::regex path(
      R"((^|[\s(])((core|raytrace|sources|receivers|photovoltaics|images|attitude|inference|)"
      R"(diagnosis|scenes|tools|python|tests|docs)(/[\w.*-]+)+))");
  static const std::regex placeholder(R"([A-Z]{3}|\*)");
  std::vector<std::string> all = matches(text, source, 0);
  for (const std::string& found : matches(text, path, 2)) all.push_back(found);
  std::erase_if(all, [](const std::string& p) { return std::regex_search(p, placeholder); });
  return all;
}

TEST(Documents, PathsInBackquotesExist) {
  static const std::regex quoted(R"(`([^`\n]+)`)");
  size_t checked = 0;
  for (const fs::path& document : documents()) {
    for (const std::string& span : matches(text_of(document), quoted, 1)) {
      for (const std::string& path : paths_in(span)) {
        EXPECT_TRUE(exists(path)) << document << " names " << path;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 100u);
}

// The code of all sources at this path, or whose path ends in it.
std::string code_at(const std::string& path) {
  std::string code;
  for (const fs::path& file : all_sources()) {
    const std::string name = fs::relative(file, root).generic_string();
    if (name == path || name.ends_with("/" + path)) code += code_of(file);
  }
  return code;
}

// Rows `| file | functions | … |`, as in the tours of docs/contributing.md.
TEST(Documents, FunctionsStandInTheFilesOfTheirRows) {
  static const std::regex row(R"(\n\| `([\w/]+\.(?:h|cpp))` \| ([^|\n]*) \|)");
  static const std::regex name(R"(`(\w+)`)");
  size_t checked = 0;
  for (const fs::path& document : documents()) {
    const std::string text = text_of(document);
    for (std::sregex_iterator it(text.begin(), text.end(), row), end; it != end; ++it) {
      const std::string code = code_at((*it)[1]);
      for (const std::string& function : matches((*it)[2], name, 1)) {
        EXPECT_TRUE(std::regex_search(code, std::regex("\\b" + function + "\\b")))
            << document << ": " << (*it)[1] << " has no " << function;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 20u);
}

TEST(Documents, LinksLeadToFiles) {
  static const std::regex link(R"(\]\(([^)#\s]+)[^)]*\))");
  size_t checked = 0;
  for (const fs::path& document : documents()) {
    for (const std::string& target : matches(text_of(document), link, 1)) {
      if (target.find("://") != std::string::npos) continue;
      EXPECT_TRUE(fs::exists(document.parent_path() / target)) << document << " links " << target;
      ++checked;
    }
  }
  EXPECT_GT(checked, 20u);
}

TEST(Documents, CommandsExistAndEachHasARow) {
  static const std::regex called(R"((?:`|/|\n {4}|\n)photorque ([a-z][a-z-]*))");
  static const std::regex row(R"(\n\| `([a-z-]+)` \|)");
  std::set<std::string> verbs;
  for (const std::string& word : kinds_of("tools")) {
    static const std::regex name(R"rx(\nVerb kind\(\) \{\s+return \{\s*"([a-z-]+)")rx");
    const std::vector<std::string> names =
        matches(text_of(root / "tools" / (word + ".cpp")), name, 1);
    ASSERT_EQ(names.size(), 1u) << word;
    verbs.insert(names.front());
  }
  ASSERT_GE(verbs.size(), 10u);
  for (const fs::path& document : documents()) {
    for (const std::string& verb : matches(text_of(document), called, 1)) {
      EXPECT_TRUE(verbs.contains(verb)) << document << " names photorque " << verb;
    }
  }
  const std::vector<std::string> rows = matches(text_of(root / "docs/verbs.md"), row, 1);
  const std::set<std::string> told(rows.begin(), rows.end());
  for (const std::string& verb : verbs)
    EXPECT_TRUE(told.contains(verb)) << "docs/verbs.md: " << verb;
}

TEST(Documents, EveryKindIsInItsTable) {
  for (const auto& [folder, page] :
       std::map<std::string, std::string>{{"attitude", "docs/disturbances.md"},
                                          {"sources", "docs/experiment.md"},
                                          {"receivers", "docs/experiment.md"}}) {
    const std::string text = text_of(root / page);
    const std::vector<std::string> words = kinds_of(folder);
    EXPECT_GE(words.size(), 3u) << folder;
    for (const std::string& word : words) {
      const std::string name = fs::path(word).filename().string();
      EXPECT_TRUE(std::regex_search(text, std::regex("\n\\| (\\*\\*)?`" + name + "`")))
          << page << " has no row for " << word;
    }
  }
}

// tools/install and the table of dependencies in docs/install.md name the same packages.
TEST(Documents, EveryInstalledPackageHasALine) {
  static const std::regex list(R"(packages\+?=\(([^)]*)\))");
  static const std::regex name(R"([a-z0-9][a-z0-9+.-]+)");
  static const std::regex quoted(R"(`([a-z0-9][a-z0-9+.-]+)`)");
  const std::string page = text_of(root / "docs/install.md");
  const size_t table = page.find("\n| dependency |");
  ASSERT_NE(table, std::string::npos);
  const std::vector<std::string> lines =
      matches(page.substr(table, page.find("\n\n", table) - table), quoted, 1);
  std::set<std::string> installed;
  for (const std::string& packages : matches(text_of(root / "tools/install"), list, 1)) {
    for (const std::string& package : matches(packages, name, 0)) installed.insert(package);
  }
  EXPECT_GT(installed.size(), 20u);
  EXPECT_EQ(std::set<std::string>(lines.begin(), lines.end()), installed);
}

TEST(Comments, FilesThatTheyNameExist) {
  static const std::regex outside(
      R"(rtcore\.h|igrf\w*\.c|k_(sin|cos)|new-joe|build_info\.h|tiny_gltf\.h)");
  size_t checked = 0;
  for (const fs::path& file : all_sources()) {
    for (const std::string& path : paths_in(comments_of(file))) {
      if (!path.ends_with(".h") && !path.ends_with(".cpp")) continue;
      if (std::regex_search(path, outside)) continue;
      EXPECT_TRUE(exists(path)) << file << " names " << path;
      ++checked;
    }
  }
  EXPECT_GT(checked, 30u);
}

// Words that an expert would have to translate, with the field's word for each.
TEST(Words, HeadersAndDocumentsSpeakTheFields) {
  static const std::map<std::string, std::string> words = {
      {R"(flies|flown|flying|flights?)", "propagates, propagated, run"},
      {R"(beliefs?|believes?|believed)", "nominal model, prior, assumed"},
      {R"(concealed|conceals?|concealing)", "injected, injects"},
      {R"(astray|valleys?)", "diverged, local minimum"},
      {R"(foretells?|foretold|foretelling)", "predicts, predicted"},
      {R"((a|the|this|its|their|small|no|same) shares?)", "fraction"},
      {R"(mean departure)", "first moment of the BSDF"},
      {R"(ledgers?)", "power balance"},
      {R"(pulsations?)", "angular frequency"},
      {R"(furniture)", "page layout"},
      {R"(wanders?|wandering|wandered)", "migrates"},
      {R"(mends?|mended|mending)", "repairs"},
      {R"(structure left)", "residual structure"},
      {R"(sum of squares left)", "residual chi-square"},
      {R"((kept|keeps?|held|holds?) back)", "held out"},
  };
  // Names that users script against, and the parts of docs/proof.md that a run writes.
  static const std::regex kept(
      R"(`[^`\n]*`|longest_\w+|most_\w+|"mended"|beliefs_refined|<!-- \w+ begin -->[^]*?<!-- \w+ end -->)");
  std::string all;
  for (const auto& [word, instead] : words) all += (all.empty() ? "" : "|") + word;
  const std::regex any("\\b(" + all + ")\\b", std::regex::icase);
  std::vector<fs::path> files = documents();
  for (const fs::path& file : all_sources()) {
    if (file.extension() == ".h") files.push_back(file);
  }
  for (const fs::path& file : files) {
    std::string text = file.extension() == ".h" ? comments_of(file) : text_of(file);
    text = std::regex_replace(text, kept, " ");
    for (std::sregex_iterator it(text.begin(), text.end(), any), end; it != end; ++it) {
      const auto at = static_cast<size_t>(it->position());
      ADD_FAILURE() << file << " says \"" << text.substr(at < 30 ? 0 : at - 30, 70)
                    << "\"; the field's words stand in this test";
    }
  }
}

}  // namespace
