// A CSV file that appears whole or not at all.
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace palpate::report {

/// Written beside its place under another name; finish() puts it there. Without finish() nothing is
/// left behind.
class TableFile {
 public:
  /// @param columns  names, each ending in its unit
  /// @throws std::runtime_error if it cannot be written
  TableFile(std::filesystem::path file, const std::vector<std::string>& columns);
  ~TableFile();
  TableFile(const TableFile&) = delete;
  TableFile& operator=(const TableFile&) = delete;

  void write_row(std::span<const double> values);  ///< ten digits each
  void write_row(std::initializer_list<double> values) {
    write_row(std::span(values.begin(), values.size()));
  }
  /// Cells with a comma or a quotation mark are quoted.
  void write_row(const std::vector<std::string>& cells);

  /// @throws std::runtime_error if not all of it could be written
  void finish();

 private:
  std::filesystem::path file_, part_;
  std::ofstream stream_;
};

}  // namespace palpate::report
