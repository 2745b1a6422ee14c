// A table to compare with: CSV with one header line.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace palpate::report {

class ReferenceTable {
 public:
  /// @throws InputError if the file cannot be read
  explicit ReferenceTable(std::filesystem::path file);
  /// Of a file that was read already: `lines`. @throws InputError if it is empty
  ReferenceTable(std::filesystem::path file, std::istream& lines);

  std::size_t size() const { return rows_.size(); }
  /// @throws InputError naming file, line and column if there is none or it holds no number
  double at(const std::string& column, std::size_t row) const;
  /// The row whose `column` is `value`. @throws InputError if there is none
  std::size_t row_of(const std::string& column, double value) const;

 private:
  void take(std::istream& lines);

  std::filesystem::path file_;
  std::vector<std::string> names_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace palpate::report
