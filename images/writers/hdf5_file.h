// HDF5 files: the only place that uses the library.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/provenance.h"

namespace photorque {

// A file that is built in memory. Places are paths from the root, such as "/maps/irradiance";
// missing groups are created. Equal contents give equal bytes. Throws NumericalError if the library
// fails, which means lack of memory.
class Hdf5File {
 public:
  Hdf5File();
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  // One component of an HDF5 path, from a name with any characters.
  static std::string part(const std::string& name);

  // Creates a group.
  void group(const std::string& place);
  bool has(const std::string& place) const;
  // Numbers row by row; their count must match the shape.
  void numbers(const std::string& place, const std::vector<double>& values,
               const std::vector<size_t>& shape);
  void texts(const std::string& place, const std::vector<std::string>& values);
  // Attributes of an existing group or array; "/" is the root.
  void attribute(const std::string& place, const std::string& name, const std::string& text);
  void attribute(const std::string& place, const std::string& name,
                 const std::vector<double>& values);
  void attribute(const std::string& place, const std::string& name, const std::vector<int>& values);
  // Adds program, version, git hash, seed, inputs and warnings as attributes.
  void stamp(const std::string& place, const Provenance& provenance);

  // Writes the file completely or not at all. Throws InputError if it cannot be written.
  void write(const std::filesystem::path& path) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace photorque
