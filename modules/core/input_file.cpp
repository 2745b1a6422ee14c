#include "modules/core/input_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "modules/core/error.h"

namespace palpate {

std::string why_not_readable(const std::filesystem::path& file) {
  using Type = std::filesystem::file_type;
  std::error_code error;
  switch (std::filesystem::status(file, error).type()) {
    case Type::regular:
      return ::faccessat(AT_FDCWD, file.c_str(), R_OK, AT_EACCESS) == 0 ? "" : "may not be read";
    case Type::not_found:
      return "no such file";
    case Type::directory:
      return "is a folder, not a file";
    case Type::fifo:
      return "is a FIFO, not a file; write to a file first";
    case Type::none:
      return "cannot be read: " + error.message();
    default:
      return "is a device or socket, not a file";
  }
}

std::ifstream open_input(const std::filesystem::path& file) {
  if (const std::string why = why_not_readable(file); !why.empty()) {
    throw InputError(file.string() + ": " + why);
  }
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (stream) return stream;
  const std::string why = file.string() + ": cannot be opened: " + std::strerror(errno);
  if (errno == EMFILE || errno == ENFILE || errno == ENOMEM) throw std::runtime_error(why);
  throw InputError(why);
}

void check_input(const std::filesystem::path& file, std::uintmax_t most_bytes) {
  open_input(file);
  const std::uintmax_t bytes = std::filesystem::file_size(file);
  if (bytes <= most_bytes) return;
  throw InputError(file.string() + ": is " + std::to_string(bytes >> 20) +
                   " MiB long; such a file may have " + std::to_string(most_bytes >> 20) + " MiB");
}

std::string read_input(const std::filesystem::path& file, std::uintmax_t most_bytes) {
  check_input(file, most_bytes);
  std::ifstream stream = open_input(file);
  std::string text, block(1 << 16, '\0');
  errno = 0;
  while (stream.read(block.data(), std::ssize(block)) || stream.gcount() > 0) {
    text.append(block, 0, static_cast<std::size_t>(stream.gcount()));
  }
  if (!stream.bad()) return text;
  const std::string why = errno == 0 ? "" : std::string(": ") + std::strerror(errno);
  throw InputError(file.string() + ": cannot be read" + why);
}

}  // namespace palpate
