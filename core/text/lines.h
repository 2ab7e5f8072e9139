// Text cut into lines, cells and words: what every reader of text files needs before it can say
// what the pieces mean. All pieces are views into the text that was given.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/errors.h"

namespace photorque {

// Without blanks at both ends: space, tab, CR, LF, vertical tab, form feed and the end-of-file
// byte 0x1a that old programs leave.
std::string_view trimmed(std::string_view text);

// Without blanks and double quotes at both ends, as cells of a table may have them.
std::string_view unquoted(std::string_view text);

// Lines without their ends (LF, CR LF or CR).
std::vector<std::string_view> lines_of(std::string_view text);

// The cells between separators, each unquoted(); one more than there are separators. A separator
// inside quotes separates all the same.
std::vector<std::string_view> cells_of(std::string_view line, char separator = ',');
// The same into `cells`, for readers of millions of lines.
void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells);

// The pieces between any number of separating characters; none is empty.
std::vector<std::string_view> words_of(std::string_view line,
                                       std::string_view separators = " \t\r\v\f");

// "text" in quotes for a message, cut after 40 bytes.
std::string in_quotes(std::string_view text);

// Throws InputError when the beginning of a text file is UTF-16 or no text at all: readers of lines
// would find no column in it and say so misleadingly.
void require_text(std::string_view begin, const InputLocation& where);

// The lines of a text that say something: neither blank nor a comment from # on.
class DataLines {
 public:
  // `text` must outlive the reader; `file` is what messages name. See require_text().
  DataLines(std::string_view text, const std::string& file);

  // The next such line, trimmed; false at the end.
  bool next(std::string_view& line);
  // Of the line that next() gave last, or of the last line of all.
  const InputLocation& where() const { return where_; }

 private:
  std::vector<std::string_view> lines_;
  InputLocation where_;
};

}  // namespace photorque
