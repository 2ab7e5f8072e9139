// All results of a run as one HDF5 file, run.h5, for h5py, MATLAB's h5read and others:
//
//   /figures/NAME          value, standard error
//   /maps/NAME/value       row by row, y and x rising; /maps/NAME/standard_error; attributes title,
//                          unit, x_label, y_label, extent (x_low, x_high, y_low, y_high)
//   /tables/NAME/COLUMN    numbers or texts
//   /plots/NAME/AXES/CURVE/x, y, y_error   axes and curves counted from 1; attribute label
//   attributes of /        program, git_hash, seed, input_1 …, warning_1 …
#include "core/errors.h"
#include "images/drawing/map.h"
#include "images/drawing/plot.h"
#include "images/writers/hdf5_file.h"
#include "images/writers/kind.h"

namespace photorque::kinds::h5 {
namespace {

// Path below a group; throws InputError if the name is not unique.
std::string place_for(const Hdf5File& file, const std::string& group, const std::string& name) {
  std::string place = group + "/" + Hdf5File::part(name);
  if (file.has(place)) throw InputError({}, name, "two results with this name", "different names");
  return place;
}

void add_map(Hdf5File& file, const Map& map) {
  require_consistent(map);
  const std::string place = place_for(file, "/maps", map.name);
  const std::vector<size_t> shape = {static_cast<size_t>(map.height),
                                     static_cast<size_t>(map.width)};
  file.numbers(place + "/value", map.value, shape);
  if (!map.standard_error.empty()) {
    file.numbers(place + "/standard_error", map.standard_error, shape);
  }
  file.attribute(place, "title", map.title);
  file.attribute(place, "unit", map.unit);
  file.attribute(place, "x_label", map.x_label);
  file.attribute(place, "y_label", map.y_label);
  file.attribute(place, "extent",
                 std::vector<double>{map.x_low, map.x_high, map.y_low, map.y_high});
}

void add_table(Hdf5File& file, const Table& table) {
  require_consistent(table);
  const std::string place = place_for(file, "/tables", table.name);
  file.group(place);
  file.attribute(place, "title", table.title);
  for (const Table::Column& column : table.columns) {
    const std::string own = place_for(file, place, column.name);
    if (column.size() == 0) {
      file.group(own);  // a column without rows
    } else if (column.texts.empty()) {
      file.numbers(own, column.values, {column.values.size()});
    } else {
      file.texts(own, column.texts);
    }
  }
}

void add_axes(Hdf5File& file, const std::string& place, const Plot::Panel& panel) {
  file.group(place);
  file.attribute(place, "y_label", panel.y_label);
  for (size_t i = 1; const Plot::Curve& curve : panel.curves) {
    const std::string own = place + "/" + std::to_string(i++);
    file.group(own);
    file.attribute(own, "label", curve.label);
    for (const auto& [name, values] :
         {std::pair{"/x", &curve.x}, {"/y", &curve.y}, {"/y_error", &curve.y_error}}) {
      if (!values->empty()) file.numbers(own + name, *values, {values->size()});
    }
  }
}

void add_plot(Hdf5File& file, const Plot& plot) {
  require_consistent(plot);
  const std::string place = place_for(file, "/plots", plot.name);
  for (size_t i = 1; const Plot::Panel& panel : panels_of(plot)) {
    add_axes(file, place + "/" + std::to_string(i++), panel);
  }
  file.attribute(place, "title", plot.title);
  file.attribute(place, "x_label", plot.x_label);
}

std::vector<std::filesystem::path> write_run(const WriterJob& job) {
  if (job.product.quantities.empty() && job.product.maps.empty() && job.product.tables.empty() &&
      job.product.plots.empty()) {
    return {};
  }
  Hdf5File file;
  for (const Quantity& figure : job.product.quantities) {
    file.numbers(place_for(file, "/figures", figure.name),
                 {figure.estimate.value, figure.estimate.standard_error}, {2});
  }
  for (const Map& map : job.product.maps) add_map(file, map);
  for (const Table& table : job.product.tables) add_table(file, table);
  for (const Plot& plot : job.product.plots) add_plot(file, plot);
  file.stamp("/", job.provenance);
  const std::filesystem::path path = file_in(job.folder, "run", "h5");
  file.write(path);
  return {path};
}

}  // namespace

WriterKind kind() {
  return {"h5", "Everything of a run as one HDF5 file, for h5py and MATLAB", write_run};
}

}  // namespace photorque::kinds::h5
