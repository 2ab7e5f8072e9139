// Lines of a text file, which may be compressed and larger than the memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace photorque {

class TextLines {
 public:
  // Throws InputError if the file cannot be opened. Uncompressed files are read as they are. With
  // `header`, the names of the columns of a file without a header: the first line is these names,
  // separated as the first row of as many numbers, which follows; lines before that row are
  // skipped.
  explicit TextLines(const std::filesystem::path& path,
                     const std::vector<std::string>& header = {});
  ~TextLines();
  TextLines(const TextLines&) = delete;
  TextLines& operator=(const TextLines&) = delete;

  // The next line without its end ("\n", "\r\n") and without a byte-order mark; false at the end of
  // the file. A line that is not valid UTF-8 is read as Latin-1. The view is valid until the next
  // call. InputError when the file is damaged or a line is longer than a megabyte.
  bool next(std::string_view& line);
  // 1-based number of the line that next() returned last.
  int64_t number() const { return number_; }

 private:
  struct File;
  bool fill();
  void skip_to_first_row();

  std::filesystem::path path_;
  std::unique_ptr<File> file_;
  std::vector<std::string> header_;
  std::string header_line_;  // until next() returns it
  std::string buffer_, utf8_;
  size_t begin_ = 0;
  bool at_end_ = false;
  int64_t number_ = 0;
};

// All lines of a file, each with "\n". `header` and InputError as for TextLines.
std::string whole_text(const std::filesystem::path& path,
                       const std::vector<std::string>& header = {});

// Compresses to the gzip format, without name or time, so that equal texts give equal bytes.
std::string gzip(const std::string& text);

}  // namespace photorque
