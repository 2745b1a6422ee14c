// Reference solutions of the squeezed balls, read from CSV.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate::calibration {

/// Names of the columns a table is read from; other columns are ignored.
struct ReferenceColumns {
  std::string compression;        ///< approach of the plates / 2 R
  std::string force;              ///< [N]
  std::string pressure;           ///< of the cavity [Pa]; empty: the table has none
  std::string equatorial_radius;  ///< of the outer surface [mm]
};

struct ReferenceRow {
  double compression = 0;
  double force = 0;                ///< [N]
  std::optional<double> pressure;  ///< [Pa]
  double equatorial_radius = 0;    ///< [m]
};

/// Rows of a compression of at least `least_compression`, in the file's order.
/// @throws InputError naming file, line and column if the file cannot be read, a column is missing,
///         a value is not a positive number, or no row is left
std::vector<ReferenceRow> read_reference(const std::filesystem::path& file,
                                         const ReferenceColumns& columns, double least_compression);

}  // namespace palpate::calibration
