#include "studies/report/whole_file.h"

#include <stdexcept>

#include "studies/report/claims.h"

namespace palpate::report {

WholeFile::WholeFile(std::filesystem::path file)
    : file_(std::move(file)), part_(file_), stream_((part_ += "." + process_word() + ".part")) {
  if (!stream_) throw std::runtime_error("cannot write " + part_.string());
}

WholeFile::~WholeFile() {
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void WholeFile::finish() {
  stream_.close();
  if (!stream_) throw std::runtime_error("cannot write " + part_.string());
  std::filesystem::rename(part_, file_);
}

void write_whole_file(const std::filesystem::path& file, std::string_view text) {
  WholeFile whole(file);
  whole.stream() << text;
  whole.finish();
}

}  // namespace palpate::report
