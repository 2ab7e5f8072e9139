// Read-only NumPy views of numbers of the library. Nothing is copied; each array keeps the Python
// object alive that owns the numbers.
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

// Shape (n,).
py::array view(const std::vector<double>& numbers, const py::object& owner);
// Shape (rows, columns): numbers[y · columns + x].
py::array view(const std::vector<double>& numbers, size_t rows, size_t columns,
               const py::object& owner);
// Shape (…, 3): one vector per row.
py::array view(const std::vector<Vec3>& vectors, const std::vector<py::ssize_t>& shape,
               const py::object& owner);
// Value or standard error of estimates, shape (rows, columns).
py::array view(const std::vector<Estimate>& estimates, double Estimate::*number, size_t rows,
               size_t columns, const py::object& owner);

// Copies, for numbers without an owner.
py::array copy_of(const std::vector<double>& numbers);
py::array copy_of(const Vec3& vector);

}  // namespace photorque::python
