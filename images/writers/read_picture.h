// Pictures into memory.
#pragma once

#include <string>
#include <vector>

namespace photorque {

struct LinearPicture {
  int width = 0, height = 0;
  std::vector<float> rgb;  // linear in [0, 1]; row by row from the top
};

// The bytes of a PNG or JPEG with sRGB values (IEC 61966-2-1); grey ones become equal red, green
// and blue, opacity is left out. Throws InputError for other bytes, and for more than 2^26 texels,
// by the header and before anything is decoded.
LinearPicture read_picture(const std::string& bytes);

}  // namespace photorque
