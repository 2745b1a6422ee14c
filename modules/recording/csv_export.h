// A folder of CSV files, one per topic and key.
#pragma once

#include <filesystem>
#include <map>
#include <ostream>
#include <string>

#include "modules/core/whole_file.h"
#include "modules/recording/sample_reader.h"

namespace palpate::recording {

/// @throws InputError for a folder that holds tables of a recording
void check_no_tables(const std::filesystem::path& folder);

class CsvExport {
 public:
  /// Makes the folder.
  /// @param overwrite  close() puts its tables in the place of all that another export left there
  /// @throws InputError if that fails, and without `overwrite` as check_no_tables()
  CsvExport(std::filesystem::path folder, bool overwrite);
  /// Without close() the folder goes, too, if it was not there before.
  ~CsvExport();
  CsvExport(const CsvExport&) = delete;
  CsvExport& operator=(const CsvExport&) = delete;

  /// @param start_ns  receive time at which time_s is 0
  void add(const RecordedSample& sample, const messages::AnyMessage& message,
           std::int64_t start_ns);

  /// Before, none of them is there. @throws std::runtime_error naming a file that could not be
  /// written
  void close();

 private:
  std::ostream& file(const std::string& name, const std::string& columns);
  void add_inputs(const ModuleStatus& status, const std::string& times);

  std::filesystem::path folder_;
  bool overwrite_;
  bool is_new_;  ///< the folder, and nothing in it is finished
  std::map<std::string, WholeFile> files_;
};

}  // namespace palpate::recording
