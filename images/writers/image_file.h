// Image files with metadata: EXR and PNG by OpenImageIO, TIFF by libtiff. Only this folder uses
// these libraries.
//
// All three formats are written without dates, on one thread: equal contents give equal bytes. Each
// file is written completely or not at all (write_file_whole). Throws InputError if it cannot be
// written.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "images/drawing/canvas.h"

namespace photorque {

// Attributes of a file. `description` is ASCII and has a different name in each format: "comments"
// in EXR, ImageDescription in TIFF, "Description" in PNG; similarly `title` and `program`. `texts`
// and `numbers` are stored as named attributes if the format supports them (EXR).
struct ImageMetadata {
  std::string description;
  std::string title;
  std::string program;
  std::vector<std::pair<std::string, std::string>> texts = {};
  std::vector<std::pair<std::string, double>> numbers = {};
};

// One named channel of float samples, row 0 at the top.
struct ImageChannel {
  std::string name;
  std::vector<float> samples;
};

// Writes channels of equal size in a single OpenEXR part, losslessly compressed.
void write_exr(const std::filesystem::path& path, int width, int height,
               const std::vector<ImageChannel>& channels, const ImageMetadata& metadata);

// Writes each channel (at least one) as one page of 32-bit floats. Its name is in PageName and
// DocumentName (in place of the title). Most programs read this form; many reject several float
// channels in a page. Losslessly compressed.
void write_tiff(const std::filesystem::path& path, int width, int height,
                const std::vector<ImageChannel>& channels, const ImageMetadata& metadata);

// Writes an 8-bit sRGB picture.
void write_png(const std::filesystem::path& path, const Picture& picture,
               const ImageMetadata& metadata);

struct LinearPicture {
  int width = 0, height = 0;
  std::vector<float> rgb;  // linear in [0, 1]; row by row from the top
};

// Decodes a PNG or JPEG with sRGB values (IEC 61966-2-1). Grey values become equal red, green and
// blue; opacity is ignored. Throws InputError for other bytes. Throws it for more than 2^26 texels
// by the header, before decoding.
LinearPicture read_picture(const std::string& bytes);

}  // namespace photorque
