// Fuzz target: any bytes as the picture of a model.
#include "images/writers/read_picture.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace photorque;
  fuzz::may_refuse([&] {
    const LinearPicture picture = read_picture(fuzz::text_of(data, size));
    for (const float value : picture.rgb) {
      if (!(value >= 0.0F && value <= 1.0F)) std::abort();
    }
  });
  return 0;
}
