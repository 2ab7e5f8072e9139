// The content of HDF5 files, read back by the library.
#include <gtest/gtest.h>
#include <hdf5.h>

#include "images/writers/kind.h"
#include "images/writers/product.h"
#include "tests/images/sample_product.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

class Hdf5Files : public FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    write_formats(sample_product(), sample_provenance(), folder, {"vtkhdf", "h5"});
  }
  hid_t open(const std::string& name) const {
    return H5Fopen((folder / name).c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  }
};

struct Numbers {
  std::vector<hsize_t> shape;
  std::vector<double> values;
};

Numbers numbers_at(hid_t file, const std::string& place) {
  Numbers numbers;
  const hid_t set = H5Dopen2(file, place.c_str(), H5P_DEFAULT);
  EXPECT_GE(set, 0) << place;
  if (set < 0) return numbers;
  const hid_t space = H5Dget_space(set);
  numbers.shape.resize(static_cast<size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, numbers.shape.data(), nullptr);
  numbers.values.resize(static_cast<size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.values.data());
  H5Sclose(space);
  H5Dclose(set);
  return numbers;
}

template <class T>
std::vector<T> attribute_at(hid_t file, const std::string& place, const std::string& name,
                            hid_t type) {
  const hid_t attribute =
      H5Aopen_by_name(file, place.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_GE(attribute, 0) << place << " " << name;
  if (attribute < 0) return {};
  const hid_t space = H5Aget_space(attribute);
  std::vector<T> values(static_cast<size_t>(H5Sget_simple_extent_npoints(space)));
  H5Aread(attribute, type, values.data());
  H5Sclose(space);
  H5Aclose(attribute);
  return values;
}

// NaN equals NaN.
void expect_same(const std::vector<double>& one, const std::vector<double>& other) {
  ASSERT_EQ(one.size(), other.size());
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_TRUE(one[i] == other[i] || (std::isnan(one[i]) && std::isnan(other[i]))) << i;
  }
}

TEST_F(Hdf5Files, HoldEveryNumberOfAMap) {
  const Map map = sample_product().maps.front();
  const hid_t file = open("run.h5");
  const Numbers value = numbers_at(file, "/maps/" + map.name + "/value");
  EXPECT_EQ(value.shape, (std::vector<hsize_t>{static_cast<hsize_t>(map.height),
                                               static_cast<hsize_t>(map.width)}));
  expect_same(value.values, map.value);
  expect_same(numbers_at(file, "/maps/" + map.name + "/standard_error").values, map.standard_error);
  EXPECT_EQ(attribute_at<double>(file, "/maps/" + map.name, "extent", H5T_NATIVE_DOUBLE),
            (std::vector<double>{map.x_low, map.x_high, map.y_low, map.y_high}));
  H5Fclose(file);
}

TEST_F(Hdf5Files, HoldEveryFigureTableAndCurve) {
  const Product product = sample_product();
  const hid_t file = open("run.h5");
  for (const Quantity& figure : product.quantities) {
    expect_same(numbers_at(file, "/figures/" + figure.name).values,
                {figure.estimate.value, figure.estimate.standard_error});
  }
  size_t columns = 0;
  for (const Table& table : product.tables) {
    for (const Table::Column& column : table.columns) {
      if (!column.texts.empty()) continue;
      expect_same(numbers_at(file, "/tables/" + table.name + "/" + column.name).values,
                  column.values);
      ++columns;
    }
  }
  EXPECT_GT(columns, 0u);
  const Plot& plot = product.plots.front();
  expect_same(numbers_at(file, "/plots/" + plot.name + "/1/1/y").values, plot.curves[0].y);
  expect_same(numbers_at(file, "/plots/" + plot.name + "/2/1/x").values, plot.below[0].curves[0].x);
  H5Fclose(file);
}

// The layout that VTK's reader needs: numbers in the order z, y, x, points in the middle of bins.
TEST_F(Hdf5Files, AreVtkImages) {
  const Map map = sample_product().maps.front();
  const hid_t file = open(file_in("", map.name, "vtkhdf").string());
  ASSERT_GE(file, 0);
  EXPECT_EQ(attribute_at<int>(file, "/VTKHDF", "Version", H5T_NATIVE_INT),
            (std::vector<int>{1, 0}));
  EXPECT_EQ(attribute_at<int>(file, "/VTKHDF", "WholeExtent", H5T_NATIVE_INT),
            (std::vector<int>{0, map.width - 1, 0, map.height - 1, 0, 1}));
  const auto origin = attribute_at<double>(file, "/VTKHDF", "Origin", H5T_NATIVE_DOUBLE);
  const auto spacing = attribute_at<double>(file, "/VTKHDF", "Spacing", H5T_NATIVE_DOUBLE);
  EXPECT_DOUBLE_EQ(origin[0] - 0.5 * spacing[0], map.x_low);
  EXPECT_NEAR(origin[1] + (map.height - 0.5) * spacing[1], map.y_high, 1e-12);
  const Numbers value = numbers_at(file, "/VTKHDF/PointData/value");
  EXPECT_EQ(value.shape, (std::vector<hsize_t>{2, static_cast<hsize_t>(map.height),
                                               static_cast<hsize_t>(map.width)}));
  const auto middle = value.values.begin() + static_cast<std::ptrdiff_t>(map.value.size());
  expect_same({value.values.begin(), middle}, map.value);
  expect_same({middle, value.values.end()}, map.value);
  H5Fclose(file);
}

}  // namespace
}  // namespace photorque
