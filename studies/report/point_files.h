// Points of a study, kept so that a next run goes on from them: a file each, which appears whole or
// not at all and ends with a line that seals what is before it (its lines and their CRC-32). What
// was cut or changed since, or is of a version without seals, is named and not believed: there is
// no such point, and who measures it anew replaces the file.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace palpate::report {

class PointFiles {
 public:
  /// @param folder  need not be there before something is written
  /// @param log     is told, once, of each file that is not believed
  PointFiles(std::filesystem::path folder, std::ostream& log)
      : folder_(std::move(folder)), log_(&log) {}

  /// What was written under that name, without the seal; none: nothing, or it is not believed.
  /// @throws InputError if it is there and cannot be read
  std::optional<std::string> read(const std::string& name) const;
  /// @param text  whole lines
  /// @throws InputError, std::runtime_error if it cannot be written
  void write(const std::string& name, std::string_view text) const;

 private:
  std::filesystem::path folder_;
  std::ostream* log_;
  mutable std::set<std::string> told_;  ///< names
};

}  // namespace palpate::report
