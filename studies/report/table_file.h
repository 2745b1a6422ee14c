// A CSV file that appears whole or not at all.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "modules/core/whole_file.h"

namespace palpate::report {

class TableFile {
 public:
  /// @param columns  names, each ending in its unit
  /// @throws std::runtime_error if it cannot be written
  TableFile(std::filesystem::path file, const std::vector<std::string>& columns);

  void write_row(std::span<const double> values);  ///< ten digits each
  void write_row(std::initializer_list<double> values) {
    write_row(std::span(values.begin(), values.size()));
  }
  /// Cells with a comma or a quotation mark are quoted.
  void write_row(const std::vector<std::string>& cells);

  /// @throws std::runtime_error if not all of it could be written
  void finish() { file_.finish(); }

 private:
  WholeFile file_;
};

}  // namespace palpate::report
