#include "python/bindings/arrays.h"

namespace photorque::python {

py::array view(const double* first, const std::vector<py::ssize_t>& shape,
               const std::vector<py::ssize_t>& strides, const py::object& owner) {
  if (first == nullptr) return py::array_t<double>(shape);  // no numbers: an empty array
  py::array array(py::dtype::of<double>(), shape, strides, first, owner);
  // Has the effect of numpy.ndarray.setflags(write=False), which takes ten times as long.
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

namespace {

constexpr auto step = static_cast<py::ssize_t>(sizeof(double));

}  // namespace

py::array view(const std::vector<double>& numbers, const py::object& owner) {
  return view(numbers.data(), {static_cast<py::ssize_t>(numbers.size())}, {step}, owner);
}

py::array view(const std::vector<double>& numbers, size_t rows, size_t columns,
               const py::object& owner) {
  const auto width = static_cast<py::ssize_t>(columns);
  return view(numbers.data(), {static_cast<py::ssize_t>(rows), width}, {width * step, step}, owner);
}

py::array view(const std::vector<Vec3>& vectors, const std::vector<py::ssize_t>& shape,
               const py::object& owner) {
  std::vector<py::ssize_t> full = shape, strides(shape.size() + 1);
  full.push_back(3);
  strides.back() = step;
  for (size_t i = shape.size(); i > 0; --i) {
    strides[i - 1] =
        i == shape.size() ? static_cast<py::ssize_t>(sizeof(Vec3)) : strides[i] * shape[i];
  }
  return view(vectors.empty() ? nullptr : vectors.front().data(), full, strides, owner);
}

py::array view(const std::vector<Estimate>& estimates, double Estimate::*number, size_t rows,
               size_t columns, const py::object& owner) {
  const auto width = static_cast<py::ssize_t>(columns);
  const auto stride = static_cast<py::ssize_t>(sizeof(Estimate));
  return view(estimates.empty() ? nullptr : &(estimates.front().*number),
              {static_cast<py::ssize_t>(rows), width}, {width * stride, stride}, owner);
}

py::array copy_of(const std::vector<double>& numbers) {
  return py::array_t<double>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

py::array copy_of(const Vec3& vector) {
  return py::array_t<double>(3, vector.data());
}

}  // namespace photorque::python
