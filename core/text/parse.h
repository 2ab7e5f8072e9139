// Parsing of text: lines, cells and words (views of the given text), numbers and columns; checks of
// JSON texts and URIs before they are read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.h"

namespace photorque {

// The text without blanks at both ends: space, tab, CR, LF, vertical tab, form feed and the
// end-of-file byte 0x1a that old programs leave.
std::string_view trimmed(std::string_view text);

// The text without blanks and double quotes at both ends.
std::string_view unquoted(std::string_view text);

// The text with lower-case letters for A to Z.
std::string lower_case(std::string_view text);

// Lines without their ends (LF, CR LF or CR).
std::vector<std::string_view> lines_of(std::string_view text);

// The cells between separators, each unquoted(); one more than there are separators. Separators
// inside quotes also count. If blanks separate, any number of them is one separator.
std::vector<std::string_view> cells_of(std::string_view line, char separator = ',');
// Splits a line into `cells`, for readers of millions of lines.
void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells);

// The cells of a header between blanks, each unquoted(). A unit belongs to its name: "Voltage (V)",
// "U / V", "I in A".
std::vector<std::string_view> names_between_blanks(std::string_view header);

// The separator of the cells of a header: the first of tab, semicolon and comma that it contains,
// otherwise the blank.
char separator_of(std::string_view header);
// The number of a cell. A comma in it is a decimal comma unless commas separate cells. NaN for an
// empty cell and for the words nan, NaN and NA; nothing for other texts.
std::optional<double> number_of_cell(std::string_view cell, char separator);

// The name of a column whose cell in the header is `written`: the key of this value in `names`, or
// the cell itself.
std::string_view name_of_column(std::string_view written,
                                const std::map<std::string, std::string>& names);

// Whether a text is one of the words of a list in which commas separate them.
bool is_listed(std::string_view text, std::string_view list);

// The pieces between any number of separating characters; none is empty.
std::vector<std::string_view> words_of(std::string_view line,
                                       std::string_view separators = " \t\r\v\f");

// "text" in quotes for a message, cut after 40 bytes.
std::string in_quotes(std::string_view text);

// The error of a row whose number of cells differs from that of the header. The cause may be
// decimal commas.
InputError wrong_row(const InputLocation& where, size_t cells, size_t of_header);

// Throws InputError if a file begins with UTF-16 or is not text. Otherwise readers of lines would
// report a missing column.
void require_text(std::string_view begin, const InputLocation& where);

// The lines of a text that are neither blank nor a comment from # on.
class DataLines {
 public:
  // `text` must outlive the reader; `file` is the name in messages. See require_text().
  DataLines(std::string_view text, const std::string& file);

  // The next line, trimmed; false at the end.
  bool next(std::string_view& line);
  // Location of the line that next() returned last, or of the last line of the file.
  const InputLocation& where() const { return where_; }

 private:
  std::vector<std::string_view> lines_;
  InputLocation where_;
};

// A whole text as a finite number, the same in every locale; a leading plus is accepted. Returns
// nothing for any other text, also with blanks.
std::optional<double> number_in(std::string_view text);

// A number that is required: InputError at `where` under the key `what`.
double require_number(std::string_view text, const InputLocation& where, const std::string& what,
                      const std::string& expected = "a number");

// A count; InputError unless whole and in [low, high].
size_t require_count(double value, const InputLocation& where, const std::string& what, int low,
                     int high);

// The shortest text that reads back as the same number.
std::string shortest(double value);

// Numbers from a comma-separated file with a header.
struct NumberColumns {
  std::vector<std::string> header;           // all columns of the file
  std::vector<std::vector<double>> columns;  // the requested ones, in the order of the request
  std::vector<int> lines;                    // line in the file, for each row
};

// Reads the columns with these names, in any order among others; empty lines and lines that start
// with # are skipped. InputError with the line for a missing column, or a cell of these columns
// that is not a finite number.
NumberColumns read_number_columns(const std::filesystem::path& path,
                                  const std::vector<std::string>& names);

// Reads only the header of such a file.
std::vector<std::string> read_column_names(const std::filesystem::path& path);

// Size of a JSON text, determined before it is parsed.
struct JsonExtent {
  uint64_t values =
      0;          // upper limit: every value but the first follows one of [ { , : outside a string
  int depth = 0;  // nesting depth of brackets; libraries recurse once per level
};

JsonExtent extent_of_json(std::string_view text);

// Exceeds the depth of any file that programs write.
inline constexpr int deepest_json = 256;

// Escapes of URIs: "a%20b" is "a b" (RFC 3986 section 2.1). A plus sign remains one
// (only in web forms it means a space). Empty if an escape is malformed.
std::optional<std::string> percent_decoded(std::string_view text);

}  // namespace photorque
