// TIFF files; the only place for libtiff. They are built in memory: libtiff may fail to write to a
// disk without an error, and OpenImageIO 2.4 supports only one page in memory.
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>

#include "core/errors.h"
#include "core/files.h"
#include "images/writers/image_file.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

constexpr uint32_t rows_per_strip = 32;

// Above this number of bytes, offsets take 64 bits (BigTIFF): those of TIFF end at 4 GiB.
constexpr double largest_classic = 3.5e9;

// A file in memory, and its error. Exceptions must not pass through libtiff.
struct Memory {
  std::string bytes = {};
  size_t at = 0;
  std::exception_ptr exception = {};
  std::array<char, 512> error = {};  // the first error; empty for none
};

Memory& memory(thandle_t handle) {
  return *static_cast<Memory*>(handle);
}

// libtiff reads its directories again to link the next one.
tmsize_t read(thandle_t handle, void* into, tmsize_t size) {
  Memory& file = memory(handle);
  if (file.at >= file.bytes.size()) return 0;
  const size_t count = std::min(static_cast<size_t>(size), file.bytes.size() - file.at);
  std::memcpy(into, file.bytes.data() + file.at, count);
  file.at += count;
  return static_cast<tmsize_t>(count);
}

tmsize_t write(thandle_t handle, void* from, tmsize_t size) {
  Memory& file = memory(handle);
  const size_t end = file.at + static_cast<size_t>(size);
  try {
    if (end > file.bytes.size()) file.bytes.resize(end);
  } catch (...) {
    file.exception = std::current_exception();
    return 0;
  }
  std::memcpy(file.bytes.data() + file.at, from, static_cast<size_t>(size));
  file.at = end;
  return size;
}

toff_t seek(thandle_t handle, toff_t offset, int whence) {
  Memory& file = memory(handle);
  const toff_t from = whence == SEEK_CUR ? file.at : whence == SEEK_END ? file.bytes.size() : 0;
  file.at = from + offset;
  return file.at;
}

int close(thandle_t) {
  return 0;
}

toff_t size(thandle_t handle) {
  return memory(handle).bytes.size();
}

int keep_error(TIFF*, void* handle, const char*, const char* format, va_list values) {
  std::array<char, 512>& error = memory(handle).error;
  if (error[0] == '\0') std::vsnprintf(error.data(), error.size(), format, values);
  return 1;
}

int pass_over_warning(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

using Tiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

// Opens a little-endian file on every machine. Null on failure.
Tiff open(Memory& file, bool big) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(
      TIFFOpenOptionsAlloc(), &TIFFOpenOptionsFree);
  if (!options) return {nullptr, &TIFFClose};
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), &keep_error, &file);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), &pass_over_warning, nullptr);
  return {TIFFClientOpenExt("memory", big ? "wl8" : "wl", &file, &read, &write, &seek, &close,
                            &size, nullptr, nullptr, options.get()),
          &TIFFClose};
}

bool describe_page(TIFF* tiff, uint32_t width, uint32_t height, const std::string& name,
                   const ImageMetadata& metadata) {
  return TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width) &&
         TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height) &&
         TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 32) &&
         TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP) &&
         TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1) &&
         TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK) &&
         TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) &&
         TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT) &&
         TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE) &&
         TIFFSetField(tiff, TIFFTAG_PREDICTOR, PREDICTOR_FLOATINGPOINT) &&
         TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, rows_per_strip) &&
         TIFFSetField(tiff, TIFFTAG_DOCUMENTNAME, name.c_str()) &&
         TIFFSetField(tiff, TIFFTAG_PAGENAME, name.c_str()) &&
         TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, metadata.description.c_str()) &&
         TIFFSetField(tiff, TIFFTAG_SOFTWARE, metadata.program.c_str());
}

// Writes copies of the samples, because libtiff may swap bytes in place.
bool write_samples(TIFF* tiff, size_t width, const std::vector<float>& samples) {
  std::vector<float> strip;
  const size_t full = width * rows_per_strip;
  uint32_t number = 0;
  for (size_t first = 0; first < samples.size(); first += full) {
    const auto begin = samples.begin() + static_cast<ptrdiff_t>(first);
    strip.assign(begin, begin + static_cast<ptrdiff_t>(std::min(full, samples.size() - first)));
    const auto bytes = static_cast<tmsize_t>(strip.size() * sizeof(float));
    if (TIFFWriteEncodedStrip(tiff, number++, strip.data(), bytes) != bytes) return false;
  }
  return true;
}

bool write_pages(TIFF* tiff, int width, int height, const std::vector<ImageChannel>& channels,
                 const ImageMetadata& metadata) {
  if (tiff == nullptr) return false;
  return std::ranges::all_of(channels, [&](const ImageChannel& channel) {
    return describe_page(tiff, static_cast<uint32_t>(width), static_cast<uint32_t>(height),
                         channel.name, metadata) &&
           write_samples(tiff, static_cast<size_t>(width), channel.samples) &&
           TIFFWriteDirectory(tiff);
  });
}

}  // namespace

void write_tiff(const fs::path& path, int width, int height,
                const std::vector<ImageChannel>& channels, const ImageMetadata& metadata) {
  const double samples = 1.0 * width * height * static_cast<double>(channels.size());
  Memory file;
  const bool written = write_pages(open(file, sizeof(float) * samples > largest_classic).get(),
                                   width, height, channels, metadata);
  if (file.exception) std::rethrow_exception(file.exception);
  if (!written || file.error[0] != '\0') {
    const std::string found = file.error[0] != '\0' ? file.error.data() : "too little memory";
    throw InputError({path.string()}, "", found, "a picture that TIFF and memory can hold");
  }
  write_file_whole(path, file.bytes);
}

}  // namespace photorque
