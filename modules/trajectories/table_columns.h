// Which columns of a table hold time, position and rotation, and what stands between columns.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::trajectories {

/// The most fields of a line that are looked at.
inline constexpr std::size_t kMostColumns = 1000;

/// One of tab, semicolon, comma; else blanks, any number of which count as one.
char separator_of(std::string_view line);

/// The next field of `rest`, without blanks or quotation marks around it; `rest` is what follows.
/// @returns false if there is none
bool next_field(std::string_view& rest, bool& more, char separator, std::string_view& field);
std::vector<std::string> fields_of(std::string_view line, char separator);

struct TableColumns {
  /// Of time, x, y, z, qx, qy, qz, qw: which column, from 0.
  std::array<std::size_t, 8> of{};
  std::size_t wanted = 8;  ///< 4: without a rotation
  std::size_t count = 0;   ///< all columns of the table
  bool headed = true;      ///< the line was a header, not data
};

/// @param first  fields of the first line that is no comment
/// @param names  the scene's key `columns`; empty: by their own names
/// @param scalar_first  the names' quaternion begins with w
/// @throws InputError "must hold …", without a place
TableColumns find_columns(const std::vector<std::string>& first,
                          const std::vector<std::string>& names, bool scalar_first);

}  // namespace palpate::trajectories
