// Columns of a reference table.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::elements_bench {

/// The named columns of a CSV file with one header line, row by row.  (rows × columns)
/// @throws InputError naming file, line and column if the file cannot be read, a column is missing
///         or a value is not a number
std::vector<std::vector<double>> read_columns(const std::filesystem::path& file,
                                              const std::vector<std::string>& columns);

}  // namespace palpate::elements_bench
