#include "core/product.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/errors.h"

namespace photorque {

Estimate estimate_from_replicates(std::span<const double> replicates) {
  const double count = static_cast<double>(replicates.size());
  double sum = 0.0;
  for (const double x : replicates) sum += x;
  const double mean = sum / count;
  double squares = 0.0;
  for (const double x : replicates) squares += (x - mean) * (x - mean);
  return {mean, std::sqrt(squares / (count * (count - 1.0)))};
}

namespace {

// The item of this name; null if there is none.
template <class Item>
const Item* named(const std::vector<Item>& all, std::string_view name) {
  const auto found = std::ranges::find(all, name, &Item::name);
  return found == all.end() ? nullptr : &*found;
}

NumericalError fault(const Table& table, std::string_view column, const std::string& what) {
  return NumericalError("table " + table.name + ", column " + std::string(column) + ": " + what);
}

Table& append(Table& table, Table::Column column) {
  if (table.find(column.name) != nullptr) throw fault(table, column.name, "added twice");
  if (!table.columns.empty() && column.size() != table.columns.front().size()) {
    throw fault(table, column.name, "its length differs from that of the first column");
  }
  table.columns.push_back(std::move(column));
  return table;
}

}  // namespace

Table Table::of(std::string name, std::string title, const std::vector<std::string>& column_names) {
  Table table{std::move(name), std::move(title), {}};
  for (const std::string& column_name : column_names) table.add(column_name, std::vector<double>{});
  return table;
}

Table& Table::add(std::string column_name, std::vector<double> values) {
  return append(*this, {std::move(column_name), std::move(values), {}});
}

Table& Table::add(std::string column_name, std::vector<std::string> texts) {
  return append(*this, {std::move(column_name), {}, std::move(texts)});
}

Table::Column& Table::Row::cell_column(std::string_view column_name) const {
  const auto is_set = [](const Column& column) { return column.size() == 1; };
  if (index_ == 0 && table_->find(column_name) == nullptr &&
      std::ranges::all_of(table_->columns, is_set)) {
    return table_->columns.emplace_back(Column{std::string(column_name)});
  }
  Column& column = table_->column(column_name);
  if (column.size() != index_)
    throw fault(*table_, column_name, "set twice in one row, or not set in an earlier row");
  return column;
}

Table::Row& Table::Row::set(std::string_view column_name, double value) {
  Column& column = cell_column(column_name);
  if (!column.texts.empty()) throw fault(*table_, column_name, "a number in a column of texts");
  column.values.push_back(value);
  return *this;
}

Table::Row& Table::Row::set(std::string_view column_name, std::string text) {
  Column& column = cell_column(column_name);
  if (!column.values.empty()) throw fault(*table_, column_name, "a text in a column of numbers");
  column.texts.push_back(std::move(text));
  return *this;
}

Table::Row& Table::Row::set(std::string_view column_name, const char* text) {
  return set(column_name, std::string(text));
}

Table::Row Table::row() {
  size_t rows = 0;
  for (const Column& column : columns) rows = std::max(rows, column.size());
  return {*this, rows};
}

const Table::Column* Table::find(std::string_view column_name) const {
  return named(columns, column_name);
}

const Table::Column& Table::column(std::string_view column_name) const {
  const Column* const found = find(column_name);
  if (found == nullptr) throw fault(*this, column_name, "the table has no column of this name");
  return *found;
}

Table::Column& Table::column(std::string_view column_name) {
  return const_cast<Column&>(std::as_const(*this).column(column_name));
}

const Quantity* find_quantity(const Product& product, std::string_view name) {
  return named(product.quantities, name);
}

const Table* find_table(const Product& product, std::string_view name) {
  return named(product.tables, name);
}

const Table& table_named(const Product& product, std::string_view name) {
  const Table* found = find_table(product, name);
  if (found == nullptr) throw NumericalError("the run gave no table " + std::string(name));
  return *found;
}

}  // namespace photorque
