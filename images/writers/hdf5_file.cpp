#include "images/writers/hdf5_file.h"

#include <hdf5.h>

#include <algorithm>

#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"

namespace photorque {
namespace hdf5 {

hid_t required(hid_t id) {
  if (id < 0) throw NumericalError("HDF5 could not store a result");
  return id;
}

// Owner of an identifier of the library.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(required(id)), close_(close) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { close_(id_); }
  hid_t get() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

// Suppresses error messages that the library prints.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

hid_t memory_only() {
  constexpr size_t step_bytes = 1 << 20;
  const hid_t properties = required(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_fapl_core(properties, step_bytes, 0);
  return properties;
}

// Texts have a fixed length, which every reader supports. They are ASCII if possible, as VTK's
// reader requires.
hid_t text_type(size_t length, bool ascii) {
  const hid_t type = required(H5Tcopy(H5T_C_S1));
  H5Tset_size(type, std::max<size_t>(1, length));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8);
  return type;
}

bool is_ascii(const std::string& text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

}  // namespace hdf5

using namespace hdf5;

struct Hdf5File::State {
  Quiet quiet;
  Handle access{memory_only(), H5Pclose};
  Handle file{H5Fcreate("in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose};
  Handle with_groups{H5Pcreate(H5P_LINK_CREATE), H5Pclose};
  Handle untimed{H5Pcreate(H5P_DATASET_CREATE), H5Pclose};

  State() {
    H5Pset_create_intermediate_group(with_groups.get(), 1);
    H5Pset_char_encoding(with_groups.get(), H5T_CSET_UTF8);
    H5Pset_obj_track_times(untimed.get(), 0);
  }
  void put(const std::string& place, hid_t type, hid_t space, const void* data) const {
    const Handle set(H5Dcreate2(file.get(), place.c_str(), type, space, with_groups.get(),
                                untimed.get(), H5P_DEFAULT),
                     H5Dclose);
    required(H5Dwrite(set.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data));
  }
  void put_attribute(const std::string& place, const std::string& name, hid_t type, hid_t space,
                     const void* data) const {
    const Handle object(H5Oopen(file.get(), place.c_str(), H5P_DEFAULT), H5Oclose);
    const Handle attribute(
        H5Acreate2(object.get(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    required(H5Awrite(attribute.get(), type, data));
  }
  void put_list(const std::string& place, const std::string& name, hid_t type, hsize_t count,
                const void* data) const {
    const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
    put_attribute(place, name, type, space.get(), data);
  }
};

Hdf5File::Hdf5File() : state_(std::make_unique<State>()) {}
Hdf5File::~Hdf5File() = default;

std::string Hdf5File::part(const std::string& name) {
  std::string clean = clean_text(name);
  std::ranges::replace(clean, '/', '_');
  return clean.empty() || clean == "." ? "unnamed" : clean;
}

void Hdf5File::group(const std::string& place) {
  const Handle made(H5Gcreate2(state_->file.get(), place.c_str(), state_->with_groups.get(),
                               H5P_DEFAULT, H5P_DEFAULT),
                    H5Gclose);
}

bool Hdf5File::has(const std::string& place) const {
  for (size_t slash = place.find('/', 1);; slash = place.find('/', slash + 1)) {
    if (H5Lexists(state_->file.get(), place.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) {
      return false;
    }
    if (slash == std::string::npos) return true;
  }
}

void Hdf5File::numbers(const std::string& place, const std::vector<double>& values,
                       const std::vector<size_t>& shape) {
  const std::vector<hsize_t> sizes(shape.begin(), shape.end());
  const Handle space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr),
                     H5Sclose);
  state_->put(place, H5T_NATIVE_DOUBLE, space.get(), values.data());
}

void Hdf5File::texts(const std::string& place, const std::vector<std::string>& values) {
  std::vector<std::string> clean;
  size_t longest = 1;
  for (const std::string& value : values) {
    clean.push_back(clean_text(value));
    longest = std::max(longest, clean.back().size());
  }
  std::string bytes;
  for (std::string& text : clean) {
    text.resize(longest, '\0');
    bytes += text;
  }
  const hsize_t count = values.size();
  const Handle type(text_type(longest, is_ascii(bytes)), H5Tclose);
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  state_->put(place, type.get(), space.get(), bytes.data());
}

void Hdf5File::attribute(const std::string& place, const std::string& name,
                         const std::string& text) {
  std::string clean = clean_text(text);
  if (clean.empty()) clean = " ";
  const Handle type(text_type(clean.size(), is_ascii(clean)), H5Tclose);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  state_->put_attribute(place, name, type.get(), space.get(), clean.data());
}

void Hdf5File::attribute(const std::string& place, const std::string& name,
                         const std::vector<double>& values) {
  state_->put_list(place, name, H5T_NATIVE_DOUBLE, values.size(), values.data());
}

void Hdf5File::attribute(const std::string& place, const std::string& name,
                         const std::vector<int>& values) {
  state_->put_list(place, name, H5T_NATIVE_INT, values.size(), values.data());
}

void Hdf5File::stamp(const std::string& place, const Provenance& provenance) {
  attribute(place, "program", provenance.program + " " + provenance.version);
  attribute(place, "git_hash", provenance.git_hash);
  attribute(place, "seed", std::to_string(provenance.seed));
  for (size_t i = 1; const auto& [file, hash] : provenance.inputs) {
    attribute(place, "input_" + std::to_string(i++), file + " " + hash);
  }
  for (size_t i = 1; const std::string& warning : provenance.warnings) {
    attribute(place, "warning_" + std::to_string(i++), warning);
  }
}

void Hdf5File::write(const std::filesystem::path& path) const {
  required(H5Fflush(state_->file.get(), H5F_SCOPE_GLOBAL));
  const ssize_t size = H5Fget_file_image(state_->file.get(), nullptr, 0);
  if (size <= 0) throw NumericalError("HDF5 could not store a result");
  std::string bytes(static_cast<size_t>(size), '\0');
  if (H5Fget_file_image(state_->file.get(), bytes.data(), bytes.size()) != size) {
    throw NumericalError("HDF5 could not store a result");
  }
  write_file_whole(path, bytes);
}

}  // namespace photorque
