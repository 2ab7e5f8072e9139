#include "attitude/recordings/text_lines.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

constexpr size_t chunk = 1 << 16;
constexpr size_t max_line_length = 1 << 20;
constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";  // some programs start UTF-8 with it

// A line as UTF-8: if it is not valid UTF-8, its bytes are read as Latin-1, as in "Winkel [\xb0]".
std::string in_utf8(std::string_view line) {
  std::string latin;
  int following = 0;  // remaining bytes of a UTF-8 character
  bool is_utf8 = true;
  for (const char c : line) {
    const auto byte = static_cast<unsigned char>(c);
    const bool continues = (byte & 0xC0U) == 0x80U;
    is_utf8 = is_utf8 && continues == (following > 0) && byte < 0xF8;
    following = continues ? following - 1 : byte < 0xC0 ? 0 : byte < 0xE0 ? 1 : byte < 0xF0 ? 2 : 3;
    if (byte < 0x80) {
      latin += c;
    } else {
      latin += static_cast<char>(0xC0U | byte >> 6U);
      latin += static_cast<char>(0x80U | (byte & 0x3FU));
    }
  }
  return is_utf8 && following == 0 ? std::string(line) : latin;
}

}  // namespace

struct TextLines::File {
  gzFile handle;
};

TextLines::TextLines(const std::filesystem::path& path, const std::vector<std::string>& header)
    : path_(path), header_(header) {
  require_plain_file(path);
  file_ = std::make_unique<File>(File{gzopen(path.c_str(), "rb")});
  if (file_->handle == nullptr) {
    throw InputError({path.string(), 0}, "", "no file that can be read", "a recording");
  }
  if (!header_.empty()) skip_to_first_row();
}

void TextLines::skip_to_first_row() {
  fill();
  std::vector<std::string_view> cells;
  size_t width = 0;  // of the widest row of numbers
  for (size_t end = 0; (end = buffer_.find('\n', begin_)) != std::string::npos;) {
    const std::string_view line = trimmed(std::string_view(buffer_).substr(begin_, end - begin_));
    for (const char separator : {';', '\t', ',', ' '}) {
      split_cells(line, separator, cells);
      const auto is_number = [separator](std::string_view cell) {
        return cell.empty() || !std::isnan(number_of_cell(cell, separator).value_or(NAN));
      };
      if (line.empty() || !std::ranges::all_of(cells, is_number)) continue;
      width = std::max(width, cells.size());
      if (cells.size() != header_.size()) continue;
      header_line_ = joined_text(header_, std::string(1, separator),
                                 [](const std::string& name) { return "\"" + name + "\""; });
      return;
    }
    begin_ = end + 1;
    ++number_;
  }
  throw InputError(
      {path_.string()}, "header",
      "no row of " + std::to_string(header_.size()) + " numbers at the beginning",
      "as many names as the file has columns" +
          (width == 0 ? "" : ": " + std::to_string(width) + ", column_2 for one without a use"));
}

TextLines::~TextLines() {
  gzclose(file_->handle);
}

bool TextLines::fill() {
  if (at_end_) return false;
  buffer_.erase(0, begin_);
  begin_ = 0;
  const size_t had = buffer_.size();
  buffer_.resize(had + chunk);
  const int got = gzread(file_->handle, buffer_.data() + had, chunk);
  int error = Z_OK;
  const char* message = gzerror(file_->handle, &error);
  // Z_BUF_ERROR at the end means that a compressed file is truncated.
  if (got < 0 || error == Z_BUF_ERROR || error == Z_DATA_ERROR) {
    throw InputError({path_.string(), static_cast<int>(number_ + 1)}, "",
                     std::string("damaged compressed data (") + message + ")", "a whole file");
  }
  buffer_.resize(had + static_cast<size_t>(got));
  at_end_ = got == 0;
  if (number_ == 0 && had == 0) require_text(buffer_, {path_.string(), 1});
  return got > 0;
}

bool TextLines::next(std::string_view& line) {
  if (!header_.empty()) {
    line = header_line_;
    header_.clear();
    return true;
  }
  size_t end = buffer_.find('\n', begin_);
  while (end == std::string::npos) {
    const size_t searched = buffer_.size() - begin_;
    if (searched > max_line_length) {
      throw InputError({path_.string(), static_cast<int>(number_ + 1)}, "",
                       "a line of more than a megabyte", "a text file");
    }
    if (!fill()) break;
    end = buffer_.find('\n', begin_ + searched);
  }
  if (end == std::string::npos && begin_ == buffer_.size()) return false;
  const bool last = end == std::string::npos;
  if (last) end = buffer_.size();
  line = std::string_view(buffer_).substr(begin_, end - begin_);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  begin_ = last ? end : end + 1;
  if (++number_ == 1 && line.starts_with(byte_order_mark)) line.remove_prefix(3);
  if (std::ranges::any_of(line,
                          [](char c) { return (static_cast<unsigned char>(c) & 0x80U) != 0; })) {
    utf8_ = in_utf8(line);
    line = utf8_;
  }
  return true;
}

std::string whole_text(const std::filesystem::path& path, const std::vector<std::string>& header) {
  TextLines lines(path, header);
  std::string text;
  for (std::string_view line; lines.next(line);) {
    text += line;
    text += '\n';
  }
  return text;
}

std::string gzip(const std::string& text) {
  z_stream stream{};
  constexpr int gzip_window = 15 + 16;
  if (deflateInit2(&stream, 6, Z_DEFLATED, gzip_window, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw NumericalError("zlib could not be started");
  }
  std::string result(deflateBound(&stream, text.size()), '\0');
  // zlib does not write to its input, but its interface has no const.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  const int status = deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw NumericalError("zlib could not compress");
  return result;
}

}  // namespace photorque
