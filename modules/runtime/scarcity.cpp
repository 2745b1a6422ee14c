#include "modules/runtime/scarcity.h"

#include <unistd.h>

#include <array>
#include <cstring>
#include <exception>
#include <new>

#include "modules/core/error.h"

namespace palpate::runtime {
namespace {

/// Text that is there when no memory is.
std::array<char, 64> name_at_the_end{};

[[noreturn]] void say_and_leave() {
  const char* said = nullptr;
  try {
    if (const auto thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    said = kNoMemory;
  } catch (const std::system_error&) {
    said =
        "no thread can be started, or there is not enough memory; ulimit -u says how many a user "
        "may have, ulimit -v how much memory a process";
  } catch (...) {  // told as ever
  }
  if (said == nullptr) __gnu_cxx::__verbose_terminate_handler();
  for (const char* text : std::array<const char*, 4>{name_at_the_end.data(), ": ", said, "\n"}) {
    if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) break;
  }
  ::_exit(kExitFailed);
}

}  // namespace

std::string why(const std::system_error& error) {
  if (error.code() != std::errc::resource_unavailable_try_again) return error.what();
  return std::string("cannot start a thread: ") + error.what() +
         "; ulimit -u says how many a user may have, ulimit -v how much memory a process";
}

void end_in_words(const std::string& program) {
  name_at_the_end.fill('\0');
  program.copy(name_at_the_end.data(), name_at_the_end.size() - 1);
  std::set_terminate(say_and_leave);
}

}  // namespace palpate::runtime
