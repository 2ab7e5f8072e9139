// A small product of every kind, and a folder that vanishes with the test.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <regex>

#include "core/product.h"
#include "core/provenance.h"
#include "images/drawing/colour.h"
#include "tests/base64.h"

namespace photorque {

// Values without two alike, so that no mix-up of rows, columns or channels goes unnoticed.
inline Map sample_map() {
  Map map{"irradiance_plate", "Irradiance on plate", "W/m²", 7, 5, -0.35, 0.35, 0.1, 0.6};
  for (int i = 0; i < map.width * map.height; ++i) {
    map.value.push_back(100.0 / 3.0 * (i + 1));
    map.standard_error.push_back(0.01 * (i + 1));
  }
  return map;
}

inline Plot sample_plot() {
  Plot plot;
  plot.name = "iv_curve";
  plot.title = "Current over voltage";
  plot.x_label = "voltage [V]";
  plot.y_label = "current [A]";
  plot.curves = {{"traced", {0.0, 1.0, 2.0}, {1.2, 1.1, 0.2}, {0.1, 0.1, 0.1}, false},
                 {"measured", {0.5, 1.5}, {1.15, 0.9}, {0.05, 0.05}, true}};
  plot.below = {{"power [W]", {{"", {0.0, 1.0, 2.0}, {0.0, 1.1, 0.4}}}}};
  return plot;
}

inline Product sample_product() {
  Product product;
  product.quantities = {{"power_on_array_W", {27.1, 0.002}},
                        {"torque_y_N_m", {1.127e-9, 1.0 / 3.0 * 1e-12}}};
  product.maps = {sample_map()};
  product.tables = {{"budget",
                     "Budget of torques",
                     {{"effect", {}, {"static, unbalance", "the \"draft\"", "#1"}},
                      {"torque_N_m", {0.1, 1.0 / 3.0, std::nan("")}, {}}}}};
  product.plots = {sample_plot()};
  return product;
}

inline Provenance sample_provenance() {
  Provenance provenance;
  provenance.version = "12.34.56";
  provenance.git_hash = "0123456789ab+";
  provenance.seed = 987654321987654321ull;
  provenance.inputs = {{"nominal.toml", "9f3c5a7b11223344aabbccddeeff0011"},
                       {"stasis.gltf", "77aa12ff5566778899aabbccddeeff22"}};
  return provenance;
}

// The SVG document in an <img> element.
inline std::string svg_of(const std::string& img) {
  const std::string mark = "data:image/svg+xml;base64,";
  const size_t begin = img.find(mark) + mark.size();
  return test::bytes_of_base64(std::string_view(img).substr(begin, img.find('"', begin) - begin));
}

// Corners of a path, in its order.
using DrawnPath = std::vector<std::pair<double, double>>;

// The paths of an SVG that are stroked or filled ("stroke", "fill") in a colour.
inline std::vector<DrawnPath> paths_of(const std::string& svg, const std::string& how,
                                       const Rgb& colour) {
  static const std::regex path(R"re(<path style="([^"]*)" d="([^"]*)")re");
  static const std::regex corner(R"([ML] (-?[0-9.]+) (-?[0-9.]+))");
  static const std::regex shares(R"(rgb\(([0-9.]+)%,([0-9.]+)%,([0-9.]+)%\))");
  std::vector<DrawnPath> all;
  for (std::sregex_iterator p(svg.begin(), svg.end(), path), end; p != end; ++p) {
    const std::string style = ";" + (*p)[1].str(), points = (*p)[2];
    std::smatch rgb;
    const size_t at = style.find(how + ":rgb(");
    if (at == std::string::npos) continue;
    const std::string paint = style.substr(at);
    std::regex_search(paint, rgb, shares);
    if (std::abs(std::stod(rgb[1]) - 100.0 * colour.red) > 0.01 ||
        std::abs(std::stod(rgb[2]) - 100.0 * colour.green) > 0.01 ||
        std::abs(std::stod(rgb[3]) - 100.0 * colour.blue) > 0.01) {
      continue;
    }
    DrawnPath& corners = all.emplace_back();
    for (std::sregex_iterator it(points.begin(), points.end(), corner); it != end; ++it) {
      corners.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
    }
  }
  return all;
}

class FolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = std::filesystem::temp_directory_path() /
             ("photorque_" + std::string(test->test_suite_name()) + "_" + test->name() + "_" +
              std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::filesystem::path folder;
};

}  // namespace photorque
