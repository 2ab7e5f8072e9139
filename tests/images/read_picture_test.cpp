// Pictures into memory, as linear light.
#include "images/writers/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <utility>

#include "core/errors.h"
#include "core/files.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

// Two texels, (0, 188, 255) and (10, 255, 0), deflated by zlib.
const std::string two_texels_hex =
    "89504e470d0a1a0a0000000d49484452000000020000000108020000007b40e8dd0000000f49444154789c63"
    "60d8f39feb3f030009cb02c5c760f4870000000049454e44ae426082";

// Three texels of one grey, 188, whose alpha is 255, 128 and 0.
const std::string three_alphas_hex =
    "89504e470d0a1a0a0000000d49484452000000030000000108060000001be014b40000001249444154789c63d8b3"
    "67cf7f206e0062060039c8081c832ecbba0000000049454e44ae426082";

std::string bytes_of(const std::string& hex) {
  std::string bytes;
  for (size_t i = 0; i < hex.size(); i += 2) {
    bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  }
  return bytes;
}

std::string two_texels() {
  return bytes_of(two_texels_hex);
}

// IEC 61966-2-1: 188 is ((188/255 + 0.055)/1.055)^2.4 = 0.502886; 10 is 10/255/12.92 = 0.003035.
TEST(ReadPicture, GivesLinearLight) {
  const LinearPicture picture = read_picture(two_texels());
  ASSERT_EQ(picture.width, 2);
  ASSERT_EQ(picture.height, 1);
  const float expected[] = {0.0F, 0.502886F, 1.0F, 0.003035F, 1.0F, 0.0F};
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(picture.rgb[i], expected[i], 1e-5F) << i;
}

// glTF 2.0, section 3.9.2: of an opaque material alpha is ignored.
TEST(ReadPicture, ColourIsNotMultipliedByAlpha) {
  const LinearPicture picture = read_picture(bytes_of(three_alphas_hex));
  ASSERT_EQ(picture.rgb.size(), 9u);
  for (const float value : picture.rgb) EXPECT_NEAR(value, 0.502886F, 1e-5F);
}

TEST(ReadPicture, RejectsInvalidFiles) {
  const std::string good = two_texels();
  EXPECT_THROW(read_picture(""), InputError);
  EXPECT_THROW(read_picture("glTF"), InputError);
  EXPECT_THROW(read_picture(good.substr(0, 4)), InputError);
  EXPECT_THROW(read_picture(good.substr(0, 40)), InputError);
}

// Its library printed each on the terminal, beside the error.
TEST(ReadPicture, RefusesDamageWithoutAWordOfItsOwn) {
  const std::string good = two_texels();
  testing::internal::CaptureStderr();
  for (size_t at = 8; at < good.size(); ++at) {
    std::string damaged = good;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    EXPECT_THROW(read_picture(damaged), InputError) << at;
    EXPECT_THROW(read_picture(good.substr(0, at)), InputError) << at;
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// A picture with another size in its header, whose checksum is right (ISO 3309, as PNG has it).
std::string of_size(uint32_t width, uint32_t height) {
  std::string bytes = two_texels();
  const auto put = [&](size_t at, uint32_t value) {
    for (size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<char>(value >> (24 - 8 * k));
  };
  put(16, width);
  put(20, height);
  uint32_t sum = 0xffffffffU;
  for (size_t i = 12; i < 29; ++i) {
    sum ^= static_cast<unsigned char>(bytes[i]);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ ((sum & 1U) != 0U ? 0xedb88320U : 0U);
  }
  put(29, ~sum);
  return bytes;
}

// 12,000 x 12,000 texels took 3.5 GB before.
TEST(ReadPicture, RejectsTooLargeFilesByTheirHeader) {
  EXPECT_EQ(of_size(2, 1), two_texels());
  EXPECT_EQ(refusal_of([&] { read_picture(of_size(12000, 12000)); }),
            "picture: found 12000 x 12000 texels, expected at most 67108864 of them");
  EXPECT_THROW(read_picture(of_size(8192, 8192)), InputError);  // whose rows are not there
}

// Found by fuzzing: for 862 bytes of a progressive JPEG 2.4 GB were taken as soon as it was opened.
TEST(ReadPicture, RefusesSizesThatItsBytesCannotHold) {
  const auto refusal = [](const std::string& bytes) -> std::string {
    return refusal_of([&] { read_picture(bytes); });
  };
  const std::filesystem::path seeds =
      std::filesystem::path(PHOTORQUE_SOURCE_DIR) / "tests/fuzz/seeds/picture";
  for (const auto& [name, marker] :
       {std::pair{"grey.jpg", "\xff\xc0"}, {"progressive.jpg", "\xff\xc2"}}) {
    std::string jpeg = read_file(seeds / name);
    EXPECT_EQ(read_picture(jpeg).rgb.size(), 3u * 8 * 8);
    const size_t frame = jpeg.find(marker);  // then length (2), depth (1), height and width
    ASSERT_NE(frame, std::string::npos);
    const auto sized = [&](const std::string& side) {
      for (const size_t at : {frame + 5, frame + 7}) jpeg.replace(at, 2, side);
      return refusal(jpeg);
    };
    EXPECT_THAT(sized("\x1f\xff"), testing::HasSubstr("67092481 texels in "));
    EXPECT_THAT(sized("\xff\xff"), testing::HasSubstr("65535 x 65535 texels"));
  }
  EXPECT_THAT(refusal(of_size(8192, 8192)), testing::HasSubstr("67108864 texels in 72 bytes"));
}

}  // namespace
}  // namespace photorque
