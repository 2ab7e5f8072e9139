#include "attitude/recordings/text_lines.h"

#include <zlib.h>

#include "core/errors.h"
#include "core/files.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

constexpr size_t chunk = 1 << 16;
constexpr size_t max_line_length = 1 << 20;
constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";  // some programs start UTF-8 with it

}  // namespace

struct TextLines::File {
  gzFile handle;
};

TextLines::TextLines(const std::filesystem::path& path) : path_(path) {
  require_plain_file(path);
  file_ = std::make_unique<File>(File{gzopen(path.c_str(), "rb")});
  if (file_->handle == nullptr) {
    throw InputError({path.string(), 0}, "", "no file that can be read", "a recording");
  }
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
  return true;
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
