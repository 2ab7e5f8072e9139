#include "python/bindings/lamp.h"

#include <pybind11/numpy.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "core/constants.h"
#include "core/errors.h"
#include "core/provenance.h"
#include "sources/lamps/settings.h"

namespace photorque::python {
namespace {

using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Description of a lamp, independent of a run.
struct LampHandle {
  std::string name;
  py::object emit;
  double power_W = 0.0;
  Spectrum spectrum;
  RigidTransform lab_from_emitter;
};

// The deleter takes the interpreter's lock, because the library releases lamps on any thread
// without it.
std::shared_ptr<py::object> shared_function(const py::object& function) {
  return {new py::object(function), [](py::object* held) {
            const py::gil_scoped_acquire lock;
            delete held;
          }};
}

// Calls `use` with the first rays of a lamp, block by block; `rays` must be a multiple of a block.
template <class Use>
void for_first_rays(const Emitter& emitter, uint32_t rays, const Use& use) {
  SampleBlock samples;
  std::array<uint32_t*, sobol_dimensions> columns;
  for (size_t d = 0; d < sobol_dimensions; ++d) columns[d] = samples.bits[d].data();
  RayBlock block;
  for (uint32_t first = 0; first < rays; first += sobol_block) {
    sobol_points({}, first, columns);
    emitter.emit(samples, block);
    use(block);
  }
}

class OwnLamp final : public Emitter {
 public:
  OwnLamp(const LampHandle& lamp, Call::Failing failing)
      : name_(lamp.name),
        power_W_(lamp.power_W),
        function_(shared_function(lamp.emit)),
        failing_(std::move(failing)) {
    find_intensity();
  }

  double power_W() const override { return power_W_; }

  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    const py::gil_scoped_acquire lock;
    try {
      evaluate(samples, rays);
    } catch (py::error_already_set& error) {
      failing_(std::move(error));
    }
  }

  // Constant over each of the cones that contain equal parts of the light.
  double relative_intensity(double angle_rad) const override {
    if (angle_rad < 0.0 || angle_rad >= edges_rad_.back()) return 0.0;
    const auto above = std::upper_bound(edges_rad_.begin() + 1, edges_rad_.end() - 1, angle_rad);
    return intensity_[static_cast<size_t>(above - edges_rad_.begin()) - 1];
  }

 private:
  static constexpr size_t cones = 128;

  void evaluate(const SampleBlock& samples, RayBlock& rays) const {
    py::array_t<double> points({py::ssize_t{ray_block}, py::ssize_t{sobol_dimensions}});
    for (int i = 0; i < ray_block; ++i) {
      for (int d = 0; d < sobol_dimensions; ++d) {
        points.mutable_at(i, d) =
            sobol_fraction(samples.bits[static_cast<size_t>(d)][static_cast<size_t>(i)]);
      }
    }
    const py::object answer = (*function_)(points);
    if (!py::isinstance<py::sequence>(answer) || py::len(answer) != 2) {
      fail("gave no pair of arrays (origin_m, direction)");
    }
    const py::sequence pair = answer;
    const Rows origin_m = rows_of(pair[0], "origins"), direction = rows_of(pair[1], "directions");
    for (int i = 0; i < ray_block; ++i) {
      const auto at = static_cast<size_t>(i);
      const Vec3 towards(direction.at(i, 0), direction.at(i, 1), direction.at(i, 2));
      const double length = towards.norm();
      if (!std::isfinite(length) || length <= 0.0) fail("gave a direction without a length");
      for (int k = 0; k < 3; ++k) {
        const double origin = origin_m.at(i, k);
        if (!std::isfinite(origin)) fail("gave an origin that is not finite");
        rays.origin_m[static_cast<size_t>(k)][at] = static_cast<float>(origin);
        rays.direction[static_cast<size_t>(k)][at] = static_cast<float>(towards[k] / length);
      }
    }
  }

  Rows rows_of(const py::object& answer, const char* what) const {
    Rows rows = Rows::ensure(answer);
    if (!rows) fail("gave " + std::string(what) + " that are not an array of numbers");
    if (rows.ndim() != 2 || rows.shape(0) != ray_block || rows.shape(1) != 3) {
      fail("gave " + std::string(what) + " of shape " + std::string(py::str(rows.attr("shape"))) +
           ", expected (n, 3), a row for each point");
    }
    return rows;
  }

  [[noreturn]] void fail(const std::string& what) const {
    PyErr_SetString(PyExc_ValueError, ("lamp \"" + name_ + "\" " + what).c_str());
    throw py::error_already_set();
  }

  // Tabulates the intensity: angles of cones about the axis that each contain 1/128 of 65,536 rays.
  void find_intensity() {
    constexpr uint32_t rays = 256 * sobol_block;
    std::vector<double> angles_rad;
    for_first_rays(*this, rays, [&](const RayBlock& block) {
      for (size_t i = 0; i < ray_block; ++i) {
        angles_rad.push_back(std::atan2(std::hypot(block.direction[0][i], block.direction[1][i]),
                                        block.direction[2][i]));
      }
    });
    std::sort(angles_rad.begin(), angles_rad.end());
    edges_rad_ = {0.0};
    for (size_t cone = 0; cone < cones; ++cone) {
      const double edge_rad = angles_rad[(cone + 1) * angles_rad.size() / cones - 1];
      // Cones of zero opening (parallel light) are omitted.
      const double solid_sr = 2.0 * pi * (std::cos(edges_rad_.back()) - std::cos(edge_rad));
      if (solid_sr <= 1e-14) continue;
      edges_rad_.push_back(edge_rad);
      intensity_.push_back(1.0 / solid_sr);
    }
    if (intensity_.empty()) {
      edges_rad_.push_back(1e-7);
      intensity_.push_back(1.0);
    }
    const double largest = *std::max_element(intensity_.begin(), intensity_.end());
    for (double& one : intensity_) one /= largest;
  }

  std::string name_;
  double power_W_;
  std::shared_ptr<py::object> function_;
  Call::Failing failing_;
  std::vector<double> edges_rad_, intensity_;
};

// Hash of the lamp in the provenance. It is computed from the emitted rays, which define the lamp
// better than its source text.
std::string hash_of(const Beam& beam) {
  constexpr uint32_t rays = 16 * sobol_block;
  std::string bytes;
  const auto add = [&](const void* from, size_t size) {
    bytes.append(static_cast<const char*>(from), size);
  };
  for_first_rays(*beam.emitter, rays, [&](const RayBlock& block) {
    add(block.origin_m.data(), sizeof block.origin_m);
    add(block.direction.data(), sizeof block.direction);
  });
  const double power_W = beam.emitter->power_W();
  add(&power_W, sizeof power_W);
  add(&beam.spectrum.centre_m, sizeof(double));
  add(&beam.spectrum.fwhm_m, sizeof(double));
  add(beam.lab_from_emitter.translation_m.data(), 3 * sizeof(double));
  add(beam.lab_from_emitter.rotation.coeffs().data(), 4 * sizeof(double));
  return content_hash(bytes);
}

double number_in(const std::string& key, double value, double low, const std::string& expected) {
  if (!std::isfinite(value) || value < low) {
    throw InputError({}, "lamp." + key, std::string(py::str(py::float_(value))), expected);
  }
  return value;
}

Vec3 vector_of(const std::string& key, const py::object& given) {
  const Rows numbers = Rows::ensure(given);
  if (!numbers || numbers.ndim() != 1 || numbers.shape(0) != 3) {
    throw InputError({}, "lamp." + key, std::string(py::str(given)), "three numbers");
  }
  Vec3 vector(numbers.at(0), numbers.at(1), numbers.at(2));
  if (!vector.allFinite()) {
    throw InputError({}, "lamp." + key, std::string(py::str(given)), "three finite numbers");
  }
  return vector;
}

LampHandle make_lamp(const py::function& emit, double power_W, double wavelength_nm,
                     const py::object& position_m, const py::object& direction,
                     const py::object& aim_m, double spectral_fwhm_nm, const std::string& name) {
  if (direction.is_none() == aim_m.is_none()) {
    throw InputError({}, "lamp", direction.is_none() ? "neither direction nor aim_m" : "both",
                     "one of direction and aim_m");
  }
  LampHandle lamp;
  lamp.name = name;
  lamp.emit = emit;
  lamp.power_W = number_in("power_W", power_W, 1e-300, "a number > 0");
  lamp.spectrum.centre_m = 1e-9 * number_in("wavelength_nm", wavelength_nm, 1e-9, "a number > 0");
  lamp.spectrum.fwhm_m =
      1e-9 * number_in("spectral_fwhm_nm", spectral_fwhm_nm, 0.0, "a number that is not negative");
  const Vec3 at_m = vector_of("position_m", position_m);
  const Vec3 towards = direction.is_none() ? Vec3(vector_of("aim_m", aim_m) - at_m)
                                           : vector_of("direction", direction);
  if (towards.norm() <= 0.0) {
    throw InputError({}, direction.is_none() ? "lamp.aim_m" : "lamp.direction", "no direction",
                     "a vector that is not zero");
  }
  lamp.lab_from_emitter = lamp_frame(towards, at_m);
  return lamp;
}

}  // namespace

void bind_lamp(py::module_& module) {
  py::class_<LampHandle>(
      module, "Lamp",
      "A lamp whose rays are computed by a Python function.\n\n"
      "emit(points) maps points of shape (n, 4), uniform in (0, 1)⁴, to (origin_m, direction), "
      "both (n, 3), in the axes of the lamp: z is along the beam, the origin is the position of "
      "the "
      "lamp. If the beam points straight down, x is along lab x and y along lab −y; any other beam "
      "is rotated from there by the shortest rotation. Each ray carries an equal part of power_W. "
      "The result must depend only on the points, and neighbouring points should give neighbouring "
      "rays: the first two numbers select the position, the others the direction. Such a lamp is "
      "slow, because every 256 rays acquire the lock of the interpreter.")
      .def(py::init(&make_lamp), py::arg("emit"), py::kw_only(), py::arg("power_W"),
           py::arg("wavelength_nm"), py::arg("position_m"), py::arg("direction") = py::none(),
           py::arg("aim_m") = py::none(), py::arg("spectral_fwhm_nm") = 0.0,
           py::arg("name") = "lamp")
      .def_readonly("name", &LampHandle::name, "Name of the lamp in results and errors.")
      .def_readonly("power_W", &LampHandle::power_W, "Emitted power [W].")
      .def("__repr__", [](const LampHandle& lamp) {
        return "Lamp(\"" + lamp.name + "\", " + std::string(py::str(py::float_(lamp.power_W))) +
               " W)";
      });
}

void add_lamps(RunOptions& options, const py::iterable& lamps, const Call& call) {
  for (const py::handle one : lamps) {
    if (!py::isinstance<LampHandle>(one)) {
      throw InputError({}, "lamps", std::string(py::str(py::type::handle_of(one))),
                       "a list of photorque.Lamp");
    }
    const LampHandle& lamp = one.cast<const LampHandle&>();
    Beam beam{lamp.name, nullptr, lamp.lab_from_emitter, lamp.spectrum};
    try {
      beam.emitter = std::make_shared<const OwnLamp>(lamp, call.failing());
      options.lamps.push_back({beam, hash_of(beam)});
    } catch (const NumericalError&) {
      call.rethrow_python();
      throw;
    }
  }
}

}  // namespace photorque::python
