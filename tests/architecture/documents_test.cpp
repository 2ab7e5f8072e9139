// Statements of the documents about the tree that a program can check: files, commands, kinds,
// packages; and the phrases of all texts.
#include <gtest/gtest.h>

#include <cctype>

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

// Every file and folder of the tree from the top, without files of builds and runs.
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
  const std::set<std::string> listed(rows.begin(), rows.end());
  for (const std::string& verb : verbs)
    EXPECT_TRUE(listed.contains(verb)) << "docs/verbs.md: " << verb;
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

// tests/architecture/phrases.txt: phrases that texts do not use, each with its replacement.
struct Phrase {
  std::vector<std::string> words;
  std::string instead;
  bool opens = false;                // the first words of a comment
  bool names = false;                // a part of a name
  std::vector<std::string> outside;  // paths where it is not looked for
};

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (size_t i = 0; i < text.size();) {
    const auto is_letter = [&](size_t at) {
      const auto c = static_cast<unsigned char>(text[at]);
      return std::isalnum(c) || c == '_' || c == '\'' || c == '-' || c >= 0x80;
    };
    if (!is_letter(i)) {
      if (!std::isspace(static_cast<unsigned char>(text[i]))) words.emplace_back(1, text[i]);
      ++i;
      continue;
    }
    std::string word;
    for (; i < text.size() && is_letter(i); ++i) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
    }
    words.push_back(word);
  }
  return words;
}

std::vector<Phrase> phrases() {
  std::istringstream list(text_of(root / "tests/architecture/phrases.txt"));
  std::vector<Phrase> all;
  std::vector<std::string> outside;
  bool opens = false, names = false;
  for (std::string line; std::getline(list, line);) {
    if (line.empty() || line.starts_with('#')) continue;
    if (line.starts_with('[')) {
      std::istringstream heading(line.substr(1, line.find(']') - 1));
      std::string kind;
      heading >> kind;
      EXPECT_TRUE(kind == "everywhere" || kind == "outside" || kind == "openings" ||
                  kind == "names")
          << line;
      opens = kind == "openings";
      names = kind == "names";
      if (!opens) outside.clear();
      for (std::string path; heading >> path;) outside.push_back(path);
      continue;
    }
    const size_t arrow = line.find(" => ");
    EXPECT_NE(arrow, std::string::npos) << line;
    all.push_back({words_of(line.substr(0, arrow)), line.substr(arrow + 4), opens, names, outside});
  }
  return all;
}

// The mark that begins a comment in this file, "md" for documents, empty for files without texts.
std::string comment_mark(const std::string& path) {
  if (path == "images/browser/script/page.min.js" || path.starts_with("tests/data/") ||
      path.starts_with("tests/fuzz/corpus/") || path.starts_with("tests/fuzz/seeds/") ||
      path.find("node_modules") != std::string::npos) {
    return "";
  }
  const fs::path name = fs::path(path).filename();
  const std::string extension = name.extension().string();
  if (extension == ".md") return "md";
  if (std::set<std::string>{".h", ".cpp", ".js"}.contains(extension)) return "//";
  const bool is_script =
      std::set<std::string>{".py", ".pyi", ".toml", ".cmake", ".sh", ".zsh"}.contains(extension) ||
      name == "CMakeLists.txt" || (extension.empty() && path.starts_with("tools/"));
  return is_script && fs::is_regular_file(root / path) ? "#" : "";
}

// The first words of every comment in a file.
std::vector<std::string> openings_of(const std::string& text, const std::string& mark) {
  std::istringstream lines(text);
  std::vector<std::string> openings;
  bool was_comment = false;
  for (std::string line; std::getline(lines, line);) {
    const size_t begin = line.find_first_not_of(' ');
    const bool is_comment =
        begin != std::string::npos && line.compare(begin, mark.size(), mark) == 0;
    if (is_comment && !was_comment) openings.push_back(line.substr(begin + mark.size()));
    was_comment = is_comment;
  }
  return openings;
}

TEST(Words, TextsUseNoPhraseOfTheList) {
  std::vector<Phrase> all = phrases();
  std::erase_if(all, &Phrase::names);
  std::multimap<std::string, const Phrase*> by_first;
  for (const Phrase& phrase : all) {
    ASSERT_FALSE(phrase.words.empty());
    by_first.emplace(phrase.words.front(), &phrase);
  }
  ASSERT_GT(by_first.size(), 90u);
  size_t files = 0;
  for (const std::string& path : tree()) {
    const std::string mark = comment_mark(path);
    if (mark.empty()) continue;
    ++files;
    const std::string text = text_of(root / path);
    const auto find = [&](const std::string& prose, bool in_openings) {
      const std::vector<std::string> words = words_of(prose);
      for (size_t i = 0; i < (in_openings ? std::min<size_t>(1, words.size()) : words.size());
           ++i) {
        const auto [begin, end] = by_first.equal_range(words[i]);
        for (auto it = begin; it != end; ++it) {
          const Phrase& phrase = *it->second;
          if (phrase.opens != in_openings || words.size() - i < phrase.words.size() ||
              !std::equal(phrase.words.begin(), phrase.words.end(),
                          words.begin() + static_cast<long>(i)) ||
              std::ranges::any_of(phrase.outside,
                                  [&](const std::string& p) { return path.starts_with(p); })) {
            continue;
          }
          std::string around;
          for (size_t k = i < 6 ? 0 : i - 6; k < std::min(words.size(), i + 8); ++k) {
            around += words[k] + " ";
          }
          ADD_FAILURE() << path << " contains \"" << around << "\"; instead: " << phrase.instead
                        << " (tests/architecture/phrases.txt)";
        }
      }
    };
    find(mark == "md" ? prose_of_document(text) : prose_of_code(text, mark), false);
    if (mark == "md") continue;
    for (const std::string& opening : openings_of(text, mark)) find(opening, true);
  }
  EXPECT_GT(files, 1000u);
}

// "likeliest_scale", "TellsApart": the words of a name, in small letters.
std::set<std::string> words_of_names(const std::string& code) {
  static const std::regex word("[A-Z]?[a-z]+");
  std::set<std::string> words;
  for (std::string found : matches(code, word, 0)) {
    found.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(found.front())));
    words.insert(std::move(found));
  }
  return words;
}

TEST(Words, NamesContainNoWordOfTheList) {
  std::vector<Phrase> all = phrases();
  std::erase_if(all, [](const Phrase& phrase) { return !phrase.names; });
  ASSERT_GT(all.size(), 10u);
  size_t files = 0;
  for (const std::string& path : tree()) {
    if (!is_source(path) || path.starts_with("tests/data/")) continue;
    ++files;
    const std::set<std::string> words = words_of_names(code_of(root / path));
    for (const Phrase& phrase : all) {
      EXPECT_FALSE(words.contains(phrase.words.front()))
          << path << " has a name with \"" << phrase.words.front()
          << "\"; instead: " << phrase.instead << " (tests/architecture/phrases.txt)";
    }
  }
  EXPECT_GT(files, 1000u);
  EXPECT_TRUE(words_of_names("int TellsApart = likeliest_scale;").contains("tells"));
  EXPECT_TRUE(words_of_names("int TellsApart = likeliest_scale;").contains("likeliest"));
}

TEST(Words, PhrasesAreFoundInCommentsStringsAndDocuments) {
  const auto holds = [](const std::string& prose, const std::string& phrase) {
    const std::vector<std::string> words = words_of(prose), wanted = words_of(phrase);
    return std::search(words.begin(), words.end(), wanted.begin(), wanted.end()) != words.end();
  };
  EXPECT_TRUE(holds(prose_of_code("int x;  // one\n// two, three\n", "//"), "one two"));
  EXPECT_TRUE(holds(prose_of_code("f(\"zero one \"\n  \"two\");", "//"), "one two"));
  EXPECT_TRUE(holds(prose_of_code("x = 1  # One\n", "#"), "one"));
  EXPECT_TRUE(holds(prose_of_document("One\ntwo.\n"), "one two"));
  EXPECT_FALSE(holds(prose_of_code("int one = two(three, four);", "//"), "one"));
  EXPECT_FALSE(holds(prose_of_code("f(\"one\");  // `two`", "//"), "one"));
  EXPECT_FALSE(holds(prose_of_code("f(\"one\");  // `two`", "//"), "two"));
  EXPECT_FALSE(holds(prose_of_document("`one` <!-- x begin -->one<!-- x end -->"), "one"));
  EXPECT_EQ(openings_of("// One\n// two\nint x;\n  // Three\n", "//"),
            (std::vector<std::string>{" One", " Three"}));
}

// Prose of a document: paragraphs and items of lists, without tables, code and generated text.
std::vector<std::string> paragraphs_of(const std::string& document) {
  static const std::regex item(R"(^\s*([-*]|\d+\.) )");
  std::istringstream lines(prose_of_document(document));
  std::vector<std::string> paragraphs(1);
  bool is_code = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) is_code = !is_code;
    const bool ends = line.empty() || line.starts_with('|') || line.starts_with('#') ||
                      line.starts_with('<') || line.starts_with("    ") ||
                      line.starts_with("```") || is_code;
    if (ends || std::regex_search(line, item)) paragraphs.emplace_back();
    if (!ends) paragraphs.back() += std::regex_replace(line, item, "") + " ";
  }
  return paragraphs;
}

TEST(Words, SentencesOfDocumentsHaveAtMost35Words) {
  static const std::regex end(R"([.:;?!]\s+)"), word(R"(\S+)"), link(R"(\]\([^)]*\))");
  size_t sentences = 0;
  for (const fs::path& document : documents()) {
    for (const std::string& paragraph : paragraphs_of(text_of(document))) {
      const std::string text = std::regex_replace(paragraph, link, "]");
      for (std::sregex_token_iterator it(text.begin(), text.end(), end, -1), last; it != last;
           ++it) {
        const std::string sentence = *it;
        const auto count = std::distance(
            std::sregex_iterator(sentence.begin(), sentence.end(), word), std::sregex_iterator());
        EXPECT_LE(count, 35) << document << ": " << sentence;
        sentences += count > 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(sentences, 1000u);
}

TEST(Words, EntriesOfTheChangelogHaveAtMost160Characters) {
  static const std::regex entry(R"(\n- [^\n]*(\n  [^\n]+)*)"), blanks(R"(\s+)");
  const std::string text = text_of(root / "CHANGELOG.md");
  size_t entries = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), entry), last; it != last; ++it) {
    const std::string line = std::regex_replace(it->str().substr(1), blanks, " ");
    EXPECT_LE(std::ranges::count_if(line, [](char c) { return (c & 0xC0) != 0x80; }), 160) << line;
    ++entries;
  }
  EXPECT_GT(entries, 50u);
}

TEST(Words, LinesOfDocumentsHaveAtMost140Characters) {
  std::vector<fs::path> files = documents();
  files.push_back(root / "CHANGELOG.md");
  for (const fs::path& document : files) {
    std::istringstream lines(prose_of_document(text_of(document)));
    bool is_code = false;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("```")) is_code = !is_code;
      if (is_code || line.starts_with('|') || line.starts_with("    ") || line.starts_with('!') ||
          line.starts_with('<'))
        continue;
      const auto letters = std::ranges::count_if(line, [](char c) { return (c & 0xC0) != 0x80; });
      EXPECT_LE(letters, 140) << document << ": " << line;
    }
  }
}

}  // namespace
