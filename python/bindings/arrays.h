// Numbers of the library as NumPy arrays that look at them: nothing is copied, the arrays cannot be
// written, and each keeps the Python object alive that owns the numbers.
#pragma once

#include <pybind11/numpy.h>

#include <vector>

#include "core/product.h"
#include "core/transform.h"

namespace photorque::python {

namespace py = pybind11;

// `strides` in bytes.
py::array view(const double* first, const std::vector<py::ssize_t>& shape,
               const std::vector<py::ssize_t>& strides, const py::object& owner);

py::array view(const std::vector<double>& numbers, const py::object& owner);
// Row by row: numbers[y · columns + x].
py::array view(const std::vector<double>& numbers, size_t rows, size_t columns,
               const py::object& owner);
// Shape (…, 3), the vectors row by row.
py::array view(const std::vector<Vec3>& vectors, const std::vector<py::ssize_t>& shape,
               const py::object& owner);
// Either number of estimates that stand row by row.
py::array view(const std::vector<Estimate>& estimates, double Estimate::*number, size_t rows,
               size_t columns, const py::object& owner);

// For numbers without an owner: a copy.
py::array copy_of(const std::vector<double>& numbers);
py::array copy_of(const Vec3& vector);

}  // namespace photorque::python
