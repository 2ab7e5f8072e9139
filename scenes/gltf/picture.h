// Pictures that models carry. This folder opens none: whoever reads an experiment says how.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace photorque {

struct BaseColours {
  int width = 0, height = 0;  // texels, at least 1
  std::vector<float> rgb;     // linear red, green and blue in [0, 1]; row by row from the top
};

// From the bytes of a PNG or JPEG, whose values are sRGB as glTF has it. Throws InputError for
// bytes that are no picture.
using PictureReader = std::function<BaseColours(const std::string& bytes)>;

}  // namespace photorque
