// A CSV file that appears whole or not at all.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "modules/core/whole_file.h"

namespace palpate::report {

/// A line of a table, its end included: ten digits each.
std::string table_line(std::span<const double> values);
/// Cells with a comma, a quotation mark or a line's end are quoted.
std::string table_line(const std::vector<std::string>& cells);

class TableFile {
 public:
  /// @param columns  names, each ending in its unit
  /// @throws std::runtime_error if it cannot be written
  TableFile(std::filesystem::path file, const std::vector<std::string>& columns);

  void write_row(std::span<const double> values) { file_.stream() << table_line(values); }
  void write_row(std::initializer_list<double> values) {
    write_row(std::span(values.begin(), values.size()));
  }
  void write_row(const std::vector<std::string>& cells) { file_.stream() << table_line(cells); }

  /// @throws std::runtime_error if not all of it could be written
  void finish() { file_.finish(); }

 private:
  WholeFile file_;
};

}  // namespace palpate::report
