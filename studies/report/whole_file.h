// A file that appears whole or not at all.
#pragma once

#include <filesystem>
#include <fstream>
#include <ostream>
#include <string_view>

namespace palpate::report {

/// Written beside its place under a name of this process; finish() puts it there. Without finish()
/// nothing is left behind.
class WholeFile {
 public:
  /// @throws std::runtime_error if it cannot be written
  explicit WholeFile(std::filesystem::path file);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  std::ostream& stream() { return stream_; }
  /// @throws std::runtime_error if not all of it could be written
  void finish();

 private:
  std::filesystem::path file_, part_;
  std::ofstream stream_;
};

/// @throws std::runtime_error if it cannot be written
void write_whole_file(const std::filesystem::path& file, std::string_view text);

}  // namespace palpate::report
