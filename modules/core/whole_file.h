// Files that appear whole or not at all, whatever ends their writing: a full disk, an error,
// Ctrl-C.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <string_view>

namespace palpate {

/// "HOST-PID": of this process alone on a shared file system.
std::string process_word();

/// Whether several may write one file at a time; the one that finishes last then replaces the
/// others'.
enum class Writers : std::uint8_t { kSeveral, kOne };

/// A place beside the file, under a name of this process, to write to; finish() puts what is there
/// in the file's place. Without finish() nothing is left behind, nor when SIGINT, SIGTERM or SIGHUP
/// ends a process that does not heed them.
class FileInTheMaking {
 public:
  /// @throws InputError if the file cannot be written, is there and no regular file, or is to have
  /// one writer and has one
  explicit FileInTheMaking(const std::filesystem::path& file, Writers writers = Writers::kSeveral);
  ~FileInTheMaking();
  FileInTheMaking(const FileInTheMaking&) = delete;
  FileInTheMaking& operator=(const FileInTheMaking&) = delete;

  const std::filesystem::path& part() const { return part_; }
  /// Once all is written. It is on the disk before it bears the file's name.
  /// @throws std::runtime_error naming file and reason
  void finish();

 private:
  void lock_part();

  std::filesystem::path file_, part_;
  int lock_ = -1;  ///< on the part, of its one writer; the kernel gives it back
};

class WholeFile {
 public:
  /// @throws InputError as FileInTheMaking; std::runtime_error naming file and reason
  explicit WholeFile(const std::filesystem::path& file, Writers writers = Writers::kSeveral);
  /// By one writer, of a kind that is written anew each time, and begins with these words, which
  /// are written.
  /// @throws InputError as check_replaces_its_like(), too
  WholeFile(const std::filesystem::path& file, std::string_view beginning, const std::string& kind);

  std::ostream& stream() { return stream_; }
  /// @throws std::runtime_error naming file and reason if not all of it could be written
  void finish();

 private:
  /// A stream says that it failed, not why.
  class Buffer : public std::filebuf {
   public:
    int failure() const { return failure_; }  ///< the system's first reason; 0: none

   protected:
    std::streamsize xsputn(const char* text, std::streamsize size) override;
    int_type overflow(int_type letter) override;
    int sync() override;

   private:
    int failure_ = 0;
  };

  FileInTheMaking making_;  // outlives the stream
  std::filesystem::path file_;
  Buffer buffer_;
  std::ostream stream_{&buffer_};
};

/// @throws InputError, std::runtime_error if it cannot be written
void write_whole_file(const std::filesystem::path& file, std::string_view text);

}  // namespace palpate
