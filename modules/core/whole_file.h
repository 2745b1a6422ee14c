// Files that appear whole or not at all, whatever ends their writing: a full disk, an error,
// Ctrl-C.
#pragma once

#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <string_view>

namespace palpate {

/// "HOST-PID": of this process alone on a shared file system.
std::string process_word();

/// A place beside the file, under a name of this process, to write to; finish() puts what is there
/// in the file's place. Without finish() nothing is left behind, nor when SIGINT, SIGTERM or SIGHUP
/// ends a process that does not heed them.
class FileInTheMaking {
 public:
  /// @throws InputError if the file cannot be written, or is there and no regular file
  explicit FileInTheMaking(const std::filesystem::path& file);
  ~FileInTheMaking();
  FileInTheMaking(const FileInTheMaking&) = delete;
  FileInTheMaking& operator=(const FileInTheMaking&) = delete;

  const std::filesystem::path& part() const { return part_; }
  /// Once all is written. It is on the disk before it bears the file's name.
  /// @throws std::runtime_error naming file and reason
  void finish();

 private:
  std::filesystem::path file_, part_;
};

class WholeFile {
 public:
  /// @throws InputError as FileInTheMaking
  explicit WholeFile(const std::filesystem::path& file);
  /// Of a kind that is written anew each time, and begins with these words, which are written.
  /// @throws InputError as check_replaces_its_like(), too
  WholeFile(const std::filesystem::path& file, std::string_view beginning, const std::string& kind);

  std::ostream& stream() { return stream_; }
  /// @throws std::runtime_error if not all of it could be written
  void finish();

 private:
  FileInTheMaking making_;  // outlives the stream
  std::filesystem::path file_;
  std::ofstream stream_;
};

/// @throws InputError, std::runtime_error if it cannot be written
void write_whole_file(const std::filesystem::path& file, std::string_view text);

}  // namespace palpate
