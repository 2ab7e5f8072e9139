// Image files with metadata: EXR and PNG by OpenImageIO, TIFF by libtiff. Only this folder knows
// them.
//
// All three formats are written without dates, on one thread: equal contents give equal bytes. Each
// file appears whole or not at all (write_file_whole); InputError when it cannot be written.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "images/drawing/canvas.h"

namespace photorque {

// Attributes of a file. `description` is ASCII and is stored under the name that each format has
// for it: "comments" in EXR, ImageDescription in TIFF, "Description" in PNG. `title` and `program`
// likewise. `texts` and `numbers` are stored as named attributes where a format can (EXR).
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

// Channels of one size in a single OpenEXR part, losslessly compressed.
void write_exr(const std::filesystem::path& path, int width, int height,
               const std::vector<ImageChannel>& channels, const ImageMetadata& metadata);

// Each channel, of at least one, is one page of 32-bit floats, named by its PageName and
// DocumentName (in place of the title): the form of TIFF that most programs read, as many refuse
// several float channels in a page. Losslessly compressed.
void write_tiff(const std::filesystem::path& path, int width, int height,
                const std::vector<ImageChannel>& channels, const ImageMetadata& metadata);

void write_png(const std::filesystem::path& path, const Picture& picture,
               const ImageMetadata& metadata);

struct LinearPicture {
  int width = 0, height = 0;
  std::vector<float> rgb;  // linear in [0, 1]; row by row from the top
};

// The bytes of a PNG or JPEG with sRGB values (IEC 61966-2-1); grey ones become equal red, green
// and blue, opacity is left out. Throws InputError for other bytes, and for more than 2^26 texels,
// by the header and before anything is decoded.
LinearPicture read_picture(const std::string& bytes);

}  // namespace photorque
