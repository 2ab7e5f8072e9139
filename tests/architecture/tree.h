// The source tree as the tests of the architecture see it: its folders, rooms and texts.
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <string_view>
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

// The comments and the string literals with blanks of a source, without its code: words of one text
// follow each other, and '\x01' stands for everything between two texts and for names in
// backquotes. `mark` begins a comment: "//" or "#".
inline std::string prose_of_code(const std::string& text, const std::string& mark) {
  const bool is_cpp = mark == "//";
  std::string prose;
  const auto add = [&](std::string_view part) {
    bool is_name = false;
    for (const char c : part) {
      if (c == '`') is_name = !is_name;
      if (c == '`' || !is_name) prose += c == '`' ? '\x01' : c;
    }
  };
  // A literal of one word is a name, unless it continues the literal before it.
  bool continues = false;
  const auto add_string = [&](std::string_view part) {
    if (!continues && part.find(' ') == std::string_view::npos) {
      prose += '\x01';
    } else {
      prose += part;
      continues = true;
    }
  };
  const auto up_to = [&](const std::string& end, size_t from) {
    return std::min(text.find(end, from), text.size());
  };
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (text.compare(i, mark.size(), mark) == 0) {
      const size_t begin = text.find_first_not_of("/#", i), end = up_to("\n", i);
      prose += ' ';
      if (begin < end) add(std::string_view(text).substr(begin, end - begin));
      i = end;
    } else if (is_cpp && text.compare(i, 2, "/*") == 0) {
      const size_t end = up_to("*/", i + 2);
      add(std::string_view(text).substr(i + 2, end - i - 2));
      i = std::min(end + 2, text.size());
    } else if (is_cpp && c == 'R' && text.compare(i, 2, "R\"") == 0) {
      const size_t open = up_to("(", i);
      const std::string close = ")" + text.substr(i + 2, open - i - 2) + "\"";
      const size_t end = up_to(close, open);
      prose += '\x01' + text.substr(open + 1, end - open - 1) + '\x01';
      i = std::min(end + close.size(), text.size());
    } else if (!is_cpp && (text.compare(i, 3, "\"\"\"") == 0 || text.compare(i, 3, "'''") == 0)) {
      const size_t end = up_to(text.substr(i, 3), i + 3);
      prose += '\x01';
      add(std::string_view(text).substr(i + 3, end - i - 3));
      prose += '\x01';
      i = std::min(end + 3, text.size());
    } else if (c == '"' || (c == '\'' && (!is_cpp || i == 0 || !std::isalnum(text[i - 1])))) {
      size_t end = i + 1;
      while (end < text.size() && text[end] != c && text[end] != '\n') {
        end += text[end] == '\\' ? 2 : 1;
      }
      end = std::min(end, text.size());
      if (c == '\'' && is_cpp) {
        prose += '\x01';
      } else {
        add_string(std::string_view(text).substr(i + 1, end - i - 1));
      }
      i = std::min(end + 1, text.size());
    } else {
      const bool is_blank = std::isspace(static_cast<unsigned char>(c)) != 0;
      prose += is_blank ? ' ' : '\x01';
      continues = continues && is_blank;
      ++i;
    }
  }
  return prose;
}

// A document without names in backquotes and without the parts that commands write,
// `<!-- NAME begin -->` to `<!-- NAME end -->`.
inline std::string prose_of_document(const std::string& text) {
  static const std::regex begin(R"(<!-- ([^\n]*) begin -->)");
  std::string prose;
  auto from = text.cbegin();
  for (std::smatch found; std::regex_search(from, text.cend(), found, begin);) {
    prose.append(from, found[0].first);
    const size_t end = text.find("<!-- " + found[1].str() + " end -->",
                                 static_cast<size_t>(found[0].second - text.cbegin()));
    from = end == std::string::npos ? text.cend() : text.cbegin() + static_cast<long>(end);
  }
  prose.append(from, text.cend());
  static const std::regex name(R"(`[^`\n]+`)");
  return std::regex_replace(prose, name, "\x01");
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
