#include "modules/core/standard_streams.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "modules/core/error.h"

namespace palpate {
namespace {

/// Of a pipe or socket that nobody reads.
bool reader_is_gone(int descriptor) {
  pollfd output{descriptor, POLLOUT, 0};
  return ::poll(&output, 1, 0) == 1 && (output.revents & (POLLERR | POLLHUP)) != 0;
}

}  // namespace

void open_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest free number, which is this one. Without a /dev the number is at least taken.
    if (::open("/dev/null", O_RDWR) < 0 && ::open("/", O_RDONLY) < 0) ::_exit(kExitFailed);
  }
}

void outlive_readers() { std::signal(SIGPIPE, SIG_IGN); }

std::string why_output_is_lost() {
  static std::string first_reason;  // a stream says only that it failed
  errno = 0;
  std::cout.flush();
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::ferror(stdout) == 0 && std::cout) return first_reason;
  int failure = errno;
  if (!first_reason.empty() || reader_is_gone(STDOUT_FILENO)) return first_reason;
  // What failed earlier: asked again by the end of a line, where lines are missing.
  if (flushed) failure = ::write(STDOUT_FILENO, "\n", 1) < 0 ? errno : 0;
  first_reason = "standard output cannot be written, what was to be there is lost";
  if (failure != 0) first_reason += std::string(": ") + std::strerror(failure);
  return first_reason;
}

}  // namespace palpate
