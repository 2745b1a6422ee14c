// Tells which of several sources have gone silent, so that nothing old is taken for the present.
#pragma once

#include <cstdint>
#include <vector>

#include "modules/core/state_archive.h"

namespace palpate::runtime {

class SilenceWatch {
 public:
  /// @param sources  all silent until heard   @param limit  silent if nothing newer than this [s]
  SilenceWatch(std::size_t sources, double limit);

  /// A sample sampled at `source_time_ns` came. Sources beyond the count are ignored.
  void heard(std::size_t source, std::int64_t source_time_ns);
  bool silent(std::size_t source, std::int64_t now_ns) const;
  bool any_silent(std::int64_t now_ns) const;

  void exchange(StateArchive& archive) { archive(newest_ns_); }

 private:
  std::vector<std::int64_t> newest_ns_;
  std::int64_t limit_ns_;
};

}  // namespace palpate::runtime
