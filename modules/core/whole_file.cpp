#include "modules/core/whole_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "modules/core/error.h"
#include "modules/core/output_file.h"
#include "modules/core/signals_held_back.h"

namespace palpate {
namespace {

/// Names of what is in the making, for a signal handler; more at once are not removed by it.
std::array<std::atomic<const char*>, 64> parts_in_the_making{};

void remove_parts_and_end(int signal) {
  for (const auto& part : parts_in_the_making) {
    if (const char* const name = part.load(); name != nullptr) ::unlink(name);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // delivered when this returns
}

/// Of a file's name, in that of what is beside it: the longest that may be is 255 bytes.
constexpr std::size_t kPartOfName = 160;

/// Those that would end the process at once. Whoever heeds them comes to the destructors.
void heed_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler != SIG_DFL) continue;
    action.sa_handler = remove_parts_and_end;
    sigaction(signal, &action, nullptr);
  }
}

[[noreturn]] void cannot_write(const std::filesystem::path& file, int system_error) {
  const std::string reason =
      system_error == 0 ? "" : std::string(": ") + std::strerror(system_error);
  throw std::runtime_error("cannot write " + file.string() + reason);
}

/// Of a link what it names, which is replaced, not the link.
std::filesystem::path named_by(const std::filesystem::path& file) {
  std::error_code none;
  return std::filesystem::is_symlink(file, none) ? std::filesystem::weakly_canonical(file) : file;
}

}  // namespace

std::string process_word() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return std::string(host.data()) + "-" + std::to_string(::getpid());
}

FileInTheMaking::FileInTheMaking(const std::filesystem::path& file, Writers writers)
    : file_(named_by(file)), part_(file_) {
  const SignalsHeldBack held;  // until the handler knows the part's name
  check_writable(file_);
  std::error_code none;
  if (std::filesystem::exists(file_, none) && !std::filesystem::is_regular_file(file_, none)) {
    throw InputError(file.string() + ": cannot be written: it is there and no regular file");
  }
  const std::string beside = file_.filename().string().substr(0, kPartOfName);
  part_.replace_filename(beside + (writers == Writers::kOne ? "" : "." + process_word()) + ".part");
  if (const std::string why = why_not_writable(part_); !why.empty()) {
    throw InputError(file.string() + ": cannot be written: " + why);
  }
  if (writers == Writers::kOne) lock_part();
  for (auto& part : parts_in_the_making) {
    const char* free = nullptr;
    if (part.compare_exchange_strong(free, part_.c_str())) break;
  }
  heed_signals();
}

/// Until it is sure that what is locked still has the name: an earlier writer may just have ended.
void FileInTheMaking::lock_part() {
  struct stat held {
  }, named{};
  do {
    if (lock_ >= 0) ::close(lock_);
    lock_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (lock_ < 0) cannot_write(file_, errno);
    if (::flock(lock_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) continue;
    ::close(lock_);
    throw InputError(file_.string() + ": another program is writing it");
  } while (::fstat(lock_, &held) != 0 || ::stat(part_.c_str(), &named) != 0 ||
           held.st_ino != named.st_ino);
}

FileInTheMaking::~FileInTheMaking() {
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
  for (auto& part : parts_in_the_making) {
    const char* own = part_.c_str();
    if (part.compare_exchange_strong(own, nullptr)) break;
  }
  if (lock_ >= 0) ::close(lock_);
}

void FileInTheMaking::finish() {
  const int number = ::open(part_.c_str(), O_RDONLY | O_CLOEXEC);
  if (number < 0) cannot_write(file_, errno);
  const int failure = ::fsync(number) == 0 || errno == EINVAL ? 0 : errno;
  ::close(number);
  if (failure != 0) cannot_write(file_, failure);
  if (std::rename(part_.c_str(), file_.c_str()) != 0) cannot_write(file_, errno);
}

WholeFile::WholeFile(const std::filesystem::path& file, Writers writers)
    : making_(file, writers), file_(file) {
  errno = 0;
  if (buffer_.open(making_.part(), std::ios::out | std::ios::binary) == nullptr) {
    cannot_write(file_, errno);
  }
}

WholeFile::WholeFile(const std::filesystem::path& file, std::string_view beginning,
                     const std::string& kind)
    : WholeFile((check_replaces_its_like(file, beginning, kind), file), Writers::kOne) {
  stream_ << beginning;
}

std::streamsize WholeFile::Buffer::xsputn(const char* text, std::streamsize size) {
  errno = 0;
  const std::streamsize written = std::filebuf::xsputn(text, size);
  if (written < size && failure_ == 0) failure_ = errno;
  return written;
}

WholeFile::Buffer::int_type WholeFile::Buffer::overflow(int_type letter) {
  errno = 0;
  const int_type written = std::filebuf::overflow(letter);
  if (written == traits_type::eof() && failure_ == 0) failure_ = errno;
  return written;
}

int WholeFile::Buffer::sync() {
  errno = 0;
  const int failed = std::filebuf::sync();
  if (failed != 0 && failure_ == 0) failure_ = errno;
  return failed;
}

void WholeFile::finish() {
  stream_.flush();
  if (!stream_ || buffer_.close() == nullptr) cannot_write(file_, buffer_.failure());
  making_.finish();
}

void write_whole_file(const std::filesystem::path& file, std::string_view text) {
  WholeFile whole(file);
  whole.stream() << text;
  whole.finish();
}

}  // namespace palpate
