// Maps read back by OpenImageIO and by hand.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "images/drawing/colour.h"
#include "images/drawing/map.h"
#include "images/writers/product.h"
#include "tests/images/sample_product.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

class MapFiles : public FolderTest {
 protected:
  fs::path written(const Map& map, const std::string& format) const {
    Product product;
    product.maps = {map};
    return write_formats(product, sample_provenance(), folder, {format}).at(0);
  }
};

struct Page {
  OIIO::ImageSpec spec;
  std::vector<float> samples;
  float at(int column, int row, const std::string& channel) const {
    const int index = spec.channelindex(channel);
    return samples[(static_cast<size_t>(row) * spec.width + column) * spec.nchannels + index];
  }
};

Page read_page(const fs::path& path, int page) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input || !input->seek_subimage(page, 0)) throw std::runtime_error(OIIO::geterror());
  Page result{input->spec(), {}};
  result.samples.resize(result.spec.image_pixels() * result.spec.nchannels);
  input->read_image(page, 0, 0, result.spec.nchannels, OIIO::TypeDesc::FLOAT,
                    result.samples.data());
  return result;
}

void expect_description_of(const Map& map, const std::string& text) {
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json.at("title"), map.title);
  EXPECT_EQ(json.at("unit"), map.unit);
  EXPECT_EQ(json.at("x_low"), map.x_low);
  EXPECT_EQ(json.at("y_high"), map.y_high);
  EXPECT_EQ(json.at("provenance").at("seed"), sample_provenance().seed);
  EXPECT_EQ(json.at("provenance").at("inputs").at("stasis.gltf"),
            sample_provenance().inputs[1].second);
}

TEST_F(MapFiles, ExrHoldsBothChannelsTopRowFirst) {
  const Map map = sample_map();
  const Page page = read_page(written(map, "exr"), 0);
  EXPECT_THAT(page.spec.channelnames, ::testing::UnorderedElementsAre("value", "standard_error"));
  EXPECT_EQ(page.spec.format, OIIO::TypeDesc::FLOAT);
  for (int iy = 0; iy < map.height; ++iy) {
    for (int ix = 0; ix < map.width; ++ix) {
      const size_t i = static_cast<size_t>(iy) * map.width + ix;
      const int row = map.height - 1 - iy;
      EXPECT_EQ(page.at(ix, row, "value"), static_cast<float>(map.value[i]));
      EXPECT_EQ(page.at(ix, row, "standard_error"), static_cast<float>(map.standard_error[i]));
    }
  }
}

TEST_F(MapFiles, ExrNamesItsAttributes) {
  const Map map = sample_map();
  const OIIO::ImageSpec spec = read_page(written(map, "exr"), 0).spec;
  EXPECT_EQ(spec.get_string_attribute("photorque:unit"), map.unit);
  EXPECT_EQ(spec.get_string_attribute("photorque:git_hash"), sample_provenance().git_hash);
  double x_low = 0.0;
  ASSERT_TRUE(spec.getattribute("photorque:x_low", OIIO::TypeDesc::DOUBLE, &x_low));
  EXPECT_EQ(x_low, map.x_low);
  EXPECT_EQ(spec.get_string_attribute("DateTime"), "");
  expect_description_of(map, spec.get_string_attribute("ImageDescription"));
}

// Rows of TIFF come in strips of 32.
Map map_of_three_strips() {
  Map map = sample_map();
  map.width = 40;
  map.height = 70;
  map.value.clear();
  map.standard_error.clear();
  for (int i = 0; i < map.width * map.height; ++i) {
    map.value.push_back(100.0 / 3.0 * (i + 1));
    map.standard_error.push_back(0.01 * (i + 1));
  }
  return map;
}

class TiffMaps : public MapFiles, public ::testing::WithParamInterface<Map> {};

TEST_P(TiffMaps, HoldAPagePerChannel) {
  const Map map = GetParam();
  const fs::path path = written(map, "tiff");
  const Page values = read_page(path, 0);
  const Page errors = read_page(path, 1);
  EXPECT_EQ(values.spec.nchannels, 1);
  EXPECT_EQ(values.spec.get_string_attribute("DocumentName"), "value");
  EXPECT_EQ(errors.spec.get_string_attribute("DocumentName"), "standard_error");
  EXPECT_EQ(values.spec.get_string_attribute("tiff:PageName"), "value");
  EXPECT_EQ(errors.spec.get_string_attribute("tiff:PageName"), "standard_error");
  EXPECT_EQ(values.spec.get_string_attribute("DateTime"), "");
  expect_description_of(map, values.spec.get_string_attribute("ImageDescription"));
  for (int i = 0; i < map.width * map.height; ++i) {
    const size_t source = static_cast<size_t>(map.height - 1 - i / map.width) * map.width +
                          static_cast<size_t>(i % map.width);
    EXPECT_EQ(values.samples[i], static_cast<float>(map.value[source]));
    EXPECT_EQ(errors.samples[i], static_cast<float>(map.standard_error[source]));
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, TiffMaps, ::testing::Values(sample_map(), map_of_three_strips()),
                         [](const auto& map) {
                           return std::to_string(map.param.height) + "_rows";
                         });

TEST_F(MapFiles, ExactMapsHaveZeroErrorsAndKeepMissingValues) {
  Map map = sample_map();
  map.standard_error.clear();
  map.value[0] = std::nan("");  // lowest row, first column
  for (const std::string format : {"exr", "tiff"}) {
    const fs::path path = written(map, format);
    const bool pages = format == "tiff";
    const Page values = read_page(path, 0);
    const Page errors = read_page(path, pages ? 1 : 0);
    EXPECT_TRUE(std::isnan(values.at(0, map.height - 1, pages ? "Y" : "value")));
    EXPECT_EQ(errors.at(3, 2, pages ? "Y" : "standard_error"), 0.0F);
  }
}

TEST_F(MapFiles, PngIsThePictureWithADescription) {
  const Map map = sample_map();
  const Picture picture = page_of(map, sample_provenance()).pixels();
  const Page page = read_page(written(map, "png"), 0);
  EXPECT_EQ(page.spec.width, picture.width);
  EXPECT_EQ(page.spec.height, picture.height);
  ASSERT_EQ(page.samples.size(), picture.rgb.size());
  for (size_t i = 0; i < picture.rgb.size(); ++i) {
    ASSERT_EQ(std::lround(255.0F * page.samples[i]), picture.rgb[i]);
  }
  expect_description_of(map, page.spec.get_string_attribute("ImageDescription"));
}

// The fraction of pixels of a saturated red, which no map of sequential colours has.
double red_share(const Picture& picture) {
  size_t red = 0;
  for (size_t i = 0; i < picture.rgb.size(); i += 3) {
    red += picture.rgb[i] > 150 && picture.rgb[i + 1] < 60 && picture.rgb[i + 2] < 60;
  }
  return static_cast<double>(red) / (picture.rgb.size() / 3.0);
}

TEST(MapPicture, ShowsTheChecksThatFailed) {
  Provenance provenance = sample_provenance();
  EXPECT_EQ(red_share(page_of(sample_map(), provenance).pixels()), 0.0);
  provenance.warnings = {"the two routes differ by 31 standard errors"};
  EXPECT_GT(red_share(page_of(sample_map(), provenance).pixels()), 5e-4);
}

// A map as pixels, with the pixels of its grid.
struct MapPicture {
  Picture picture;
  int grid_left, grid_top, grid_width, grid_height;
};

MapPicture map_picture(const Map& map, const Provenance& provenance) {
  const DrawnPage page = page_of(map, provenance);
  const auto pixels = [](double points) {
    return static_cast<int>(std::lround(points * pixels_per_point(PictureStyle::page)));
  };
  return {page.pixels(), pixels(page.grid.x), pixels(page.grid.y), pixels(page.grid.width),
          pixels(page.grid.height)};
}

// Where the middle of a bin stands in the picture.
std::array<uint8_t, 3> pixel_of_bin(const MapPicture& drawn, const Map& map, int ix, int iy) {
  const double x = drawn.grid_left + drawn.grid_width * (ix + 0.5) / map.width;
  const double y = drawn.grid_top + drawn.grid_height * (map.height - iy - 0.5) / map.height;
  return drawn.picture.pixel(static_cast<int>(x), static_cast<int>(y));
}

TEST(MapPicture, BinsHaveTheColourOfTheirValue) {
  const Map map = sample_map();
  const ColourMap colours = viridis();
  const MapPicture drawn = map_picture(map, sample_provenance());
  for (int iy = 0; iy < map.height; ++iy) {
    for (int ix = 0; ix < map.width; ++ix) {
      // From zero to the largest of the values 100/3·1 … 100/3·35.
      const double fraction = (iy * map.width + ix + 1) / 35.0;
      EXPECT_EQ(pixel_of_bin(drawn, map, ix, iy), rgb_bytes(colours(fraction))) << ix << " " << iy;
    }
  }
}

// As a part of an HTML page: the bins are a PNG in it; a second one is the colour bar.
TEST_F(MapFiles, AMapInAPageHasTheColoursOfItsBins) {
  const Map map = sample_map();
  const std::string svg = svg_of(map_html(map));
  const std::string mark = "data:image/png;base64,";
  std::vector<Page> pictures;
  for (size_t at = svg.find(mark); at != std::string::npos; at = svg.find(mark, at + 1)) {
    const size_t begin = at + mark.size();
    const std::string_view digits =
        std::string_view(svg).substr(begin, svg.find('"', begin) - begin);
    write_file_whole(folder / "bins.png", test::bytes_of_base64(digits));
    pictures.push_back(read_page(folder / "bins.png", 0));
  }
  ASSERT_EQ(pictures.size(), 2u);
  const Page& page = pictures[pictures[0].spec.width < pictures[1].spec.width ? 1 : 0];
  const ColourMap colours = viridis();
  for (int iy = 0; iy < map.height; ++iy) {
    for (int ix = 0; ix < map.width; ++ix) {
      const auto expected = rgb_bytes(colours((iy * map.width + ix + 1) / 35.0));
      const int x = page.spec.width * (2 * ix + 1) / (2 * map.width);
      const int y = page.spec.height * (2 * (map.height - 1 - iy) + 1) / (2 * map.height);
      for (const auto& [channel, byte] :
           {std::pair{"R", expected[0]}, {"G", expected[1]}, {"B", expected[2]}}) {
        EXPECT_EQ(std::lround(255.0F * page.at(x, y, channel)), byte);
      }
    }
  }
}

// The field x from 0 to 4 between five nodes each way.
Map smooth_ramp() {
  Map map;
  map.name = map.title = "smooth";
  map.width = map.height = 5;
  for (int i = 0; i < 25; ++i) map.value.push_back(i % 5);
  map.smooth = true;
  return map;
}

// Colours of a smooth map change steadily from node to node, with lines at even steps.
TEST(MapPicture, SmoothMapsAreDrawnBetweenTheirNodes) {
  const Map map = smooth_ramp();
  const MapPicture drawn = map_picture(map, sample_provenance());
  const ColourMap colours = viridis();
  int exact = 0, dark = 0;
  for (int column = 0; column < drawn.grid_width; ++column) {
    const double fraction = (column + 0.5) / drawn.grid_width;
    const auto pixel =
        drawn.picture.pixel(drawn.grid_left + column, drawn.grid_top + drawn.grid_height / 2);
    const auto expected = rgb_bytes(colours(fraction));
    exact += std::abs(pixel[0] - expected[0]) + std::abs(pixel[1] - expected[1]) +
                 std::abs(pixel[2] - expected[2]) <
             8;
    dark += pixel[1] + 20 < expected[1];
  }
  EXPECT_GT(exact, 0.7 * drawn.grid_width);
  EXPECT_GT(dark, 6);
  EXPECT_LT(dark, 0.1 * drawn.grid_width);
}

// A field on a disc of 21 nodes a side fills the circle through the outermost nodes to a pixel.
TEST(MapPicture, DiscsHaveARoundRim) {
  constexpr int side = 21, size = 200;
  Map map;
  map.name = "disc";
  map.width = map.height = side;
  map.smooth = true;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const bool is_inside = std::hypot(column - 10, row - 10) <= 10.0;
      map.value.push_back(is_inside ? column : std::numeric_limits<double>::quiet_NaN());
    }
  }
  const std::vector<uint32_t> drawn = map_pixels(map, colour_scale(map), size, size);
  constexpr double middle = 0.5 * size;
  double area = 0.0;
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const double opacity = (drawn[static_cast<size_t>(row) * size + column] >> 24) / 255.0;
      const double distance = std::hypot(column + 0.5 - middle, row + 0.5 - middle);
      if (std::abs(distance - middle) > 0.6) {
        EXPECT_EQ(opacity, distance < middle ? 1.0 : 0.0) << column << " " << row;
      }
      area += opacity;
    }
  }
  EXPECT_NEAR(area, std::numbers::pi * middle * middle, 1e-3 * area);
}

TEST(MapPicture, IsAPageOfVectorsWithTextAsText) {
  const Map map = sample_map();
  const std::string page = page_of(map, {}).svg();
  EXPECT_THAT(page, testing::HasSubstr(">" + map.title + "</text>"));
  EXPECT_THAT(page, testing::HasSubstr("data:image/png;base64,"));
  EXPECT_THAT(page_of(map, {}, PictureStyle::paper).svg(),
              testing::Not(testing::HasSubstr(">" + map.title + "</text>")));
  EXPECT_THAT(page_of(map, {}).pdf({"a", "b", "c"}), testing::StartsWith("%PDF"));
}

// The field x from 0 to 4 has vertical contour lines; labels are on the lines, apart, along them.
TEST(MapPicture, ContourLinesHaveTheirNumbers) {
  const Map map = smooth_ramp();
  const auto labels = contour_labels(map, colour_scale(map), 800, 800, 60.0);
  ASSERT_GE(labels.size(), 3u);
  for (const ContourLabel& label : labels) {
    EXPECT_NEAR(4.0 * (label.column + 0.5) / 800.0, label.value, 0.02);
    EXPECT_NEAR(std::stod(label.text), label.value, 1e-9);
    EXPECT_NEAR(std::abs(label.turn_rad), std::numbers::pi / 2, 0.05);
    for (const ContourLabel& other : labels) {
      if (&other == &label) continue;
      EXPECT_GE(std::hypot(other.column - label.column, other.row - label.row), 120.0);
    }
  }
}

TEST(MapPicture, SignedZeroIsTheNeutralMiddle) {
  Map map = sample_map();
  map.signed_values = true;
  map.value.assign(map.value.size(), 0.0);
  map.value[0] = -2e-9;
  map.value[1] = 1e-9;
  map.standard_error.clear();
  const MapPicture drawn = map_picture(map, {});
  const auto [red, green, blue] = pixel_of_bin(drawn, map, 3, 3);
  EXPECT_NEAR(red, green, 4);
  EXPECT_NEAR(green, blue, 4);
  const auto negative = pixel_of_bin(drawn, map, 0, 0);
  const auto positive = pixel_of_bin(drawn, map, 1, 0);
  EXPECT_GT(negative[2], negative[0]) << "negative is blue";
  EXPECT_GT(positive[0], positive[2]) << "positive is red";
}

// Red and blue mean a significant sign: values within two standard errors of zero have none.
TEST(MapPicture, SignedValuesThatAreNotSignificantAreGrey) {
  Map map = sample_map();
  map.signed_values = true;
  map.value.assign(map.value.size(), 1.0);
  map.standard_error.assign(map.value.size(), 0.49);
  map.standard_error[1] = 0.51;
  const MapPicture drawn = map_picture(map, {});
  const auto sure = pixel_of_bin(drawn, map, 0, 0), unsure = pixel_of_bin(drawn, map, 1, 0);
  EXPECT_GT(sure[0], sure[2] + 50);
  EXPECT_EQ(unsure[0], unsure[1]);
  EXPECT_EQ(unsure[1], unsure[2]);
  EXPECT_THAT(map_caption(map), testing::HasSubstr("grey: within two standard errors of zero"));
  map.standard_error.assign(map.value.size(), 0.49);
  EXPECT_THAT(map_caption(map), testing::Not(testing::HasSubstr("grey")));
}

TEST(MapPicture, KeepsTheRatioOfTheSides) {
  Map map = sample_map();  // 0.7 m by 0.5 m
  EXPECT_NEAR(map_picture(map, {}).grid_width, map_picture(map, {}).grid_height * 1.4, 2.0);
  map.x_high = 100.0;  // beyond the readable range
  EXPECT_NEAR(map_picture(map, {}).grid_width, map_picture(map, {}).grid_height * 8.0, 8.0);
}

TEST(MapPicture, MeansOfManyBinsShareAPixel) {
  Map map = sample_map();
  map.width = 4000;
  map.height = 4;
  map.x_low = 0.0;
  map.x_high = map.y_high = 4.0;
  map.y_low = 0.0;
  map.standard_error.clear();
  map.value.assign(16000, 0.0);
  // Alternating bins of 0 and 1000: every pixel covers about five of them.
  for (size_t i = 1; i < map.value.size(); i += 2) map.value[i] = 1000.0;
  const MapPicture drawn = map_picture(map, {});
  for (int column = 0; column < drawn.grid_width; column += 7) {
    const auto pixel = drawn.picture.pixel(drawn.grid_left + column, drawn.grid_top + 5);
    EXPECT_GT(pixel[1], rgb_bytes(viridis()(0.38))[1]);
    EXPECT_LT(pixel[1], rgb_bytes(viridis()(0.62))[1]);
  }
}

// A bin at the edge of the surface, which holds a tenth of a bin of it, counts a tenth.
TEST(MapCaption, MeanIsOverTheSurface) {
  Map map = sample_map();
  map.value.assign(map.value.size(), 2.0);
  map.weight.assign(map.value.size(), 1.0);
  map.value[3] = 37.0;
  map.weight[3] = 0.1;  // (34 · 2 + 0.1 · 37) / 34.1
  EXPECT_THAT(map_caption(map), testing::HasSubstr("mean 2.103 ·"));
  map.value[0] = std::nan("");  // (33 · 2 + 3.7) / 33.1
  EXPECT_THAT(map_caption(map), testing::HasSubstr("mean 2.106 ·"));
}

// Nodes of a disc crowd nowhere in particular: their mean would be another number than the table's.
TEST(MapCaption, SmoothFieldHasNoMean) {
  Map map = sample_map();
  map.smooth = true;
  EXPECT_THAT(map_caption(map), testing::Not(testing::HasSubstr("mean")));
}

TEST(MapCaption, GivesExtremesMeanAndError) {
  Map map = sample_map();
  map.value.assign(map.value.size(), 2.0);
  map.value[3] = 37.0;  // mean 3
  map.standard_error.assign(map.standard_error.size(), 0.25);
  EXPECT_EQ(map_caption(map),
            "min 2.000 · mean 3.000 · max 37.00 W/m² · 7 × 5 bins · standard error 0.25 (rms)");
  map.value[0] = std::nan("");
  EXPECT_THAT(map_caption(map), ::testing::EndsWith("hatched: no value"));
}

}  // namespace
}  // namespace photorque
