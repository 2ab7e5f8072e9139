// HDF5 files: the only place that uses the library.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/provenance.h"

namespace photorque {

// A file that grows in memory and appears whole. Places are paths from the root,
// "/maps/irradiance": groups on the way are made. Equal contents give equal bytes. NumericalError
// when the library refuses, which is lack of memory.
class Hdf5File {
 public:
  Hdf5File();
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  // A part of an HDF5 path, from a name that may hold any character.
  static std::string part(const std::string& name);

  void group(const std::string& place);
  bool has(const std::string& place) const;
  // Row by row; as many numbers as in the shape.
  void numbers(const std::string& place, const std::vector<double>& values,
               const std::vector<size_t>& shape);
  void texts(const std::string& place, const std::vector<std::string>& values);
  // Attributes of a group or of numbers that are there; "/" is the root.
  void attribute(const std::string& place, const std::string& name, const std::string& text);
  void attribute(const std::string& place, const std::string& name,
                 const std::vector<double>& values);
  void attribute(const std::string& place, const std::string& name, const std::vector<int>& values);
  // Program, version, git hash, seed, inputs and warnings.
  void stamp(const std::string& place, const Provenance& provenance);

  void write(const std::filesystem::path& path) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace photorque
