#include "python/bindings/document.h"

namespace photorque::python {
namespace {

SettingsNode table_of(const py::dict& dict, const std::string& key) {
  SettingsNode::Table table;
  for (const auto& [name, value] : dict) {
    if (!py::isinstance<py::str>(name)) {
      throw InputError({}, key, py::str(py::repr(name)), "keys that are texts");
    }
    const auto text = name.cast<std::string>();
    std::string below = key;
    below.append(key.empty() ? "" : ".").append(text);
    table.emplace(text, settings_of(value, below));
  }
  return {table};
}

SettingsNode array_of(const py::handle& items, const std::string& key) {
  SettingsNode::Array array;
  for (const py::handle item : items) {
    array.push_back(settings_of(item, key + "[" + std::to_string(array.size()) + "]"));
  }
  return {array};
}

struct ToPython {
  py::object operator()(bool value) const { return py::bool_(value); }
  py::object operator()(int64_t value) const { return py::int_(value); }
  py::object operator()(double value) const { return py::float_(value); }
  py::object operator()(const std::string& value) const { return py::str(value); }
  py::object operator()(const SettingsNode::Array& items) const {
    py::list list;
    for (const SettingsNode& item : items) list.append(value_of(item));
    return list;
  }
  py::object operator()(const SettingsNode::Table& table) const {
    py::dict dict;
    for (const auto& [key, value] : table) dict[py::str(key)] = value_of(value);
    return dict;
  }
};

}  // namespace

SettingsNode settings_of(const py::handle& value, const std::string& key) {
  if (py::isinstance<py::bool_>(value)) return {value.cast<bool>()};
  if (py::isinstance<py::int_>(value)) {
    try {
      return {value.cast<int64_t>()};
    } catch (const py::cast_error&) {
      throw InputError({}, key, py::str(py::repr(value)), "a whole number of 64 bits");
    }
  }
  if (py::isinstance<py::float_>(value)) return {value.cast<double>()};
  if (py::isinstance<py::str>(value)) return {value.cast<std::string>()};
  if (py::isinstance<py::dict>(value)) {
    return table_of(py::reinterpret_borrow<py::dict>(value), key);
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    return array_of(value, key);
  }
  // NumPy's arrays and numbers become Python's; paths become texts.
  if (py::hasattr(value, "tolist")) return settings_of(value.attr("tolist")(), key);
  if (py::hasattr(value, "__fspath__")) return settings_of(value.attr("__fspath__")(), key);
  throw InputError({}, key, py::str(py::repr(value)),
                   "a number, text, truth value, list or dict of such");
}

py::object value_of(const SettingsNode& node) {
  return std::visit(ToPython{}, node.value);
}

}  // namespace photorque::python
