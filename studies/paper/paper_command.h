// `palpate paper`: the figures and numbers of the paper, made anew.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace palpate::paper {

struct PaperOptions {
  std::filesystem::path out = "out/paper";
  std::vector<std::string> only;  ///< of paper_parts(); empty: all
  bool quick = false;
  double budget = 240;  ///< wall time Figure 4 may take [s]
};

/// What --only takes: "1" … "4" for the figures, "speed".
std::vector<std::string> paper_parts();

/// Computes the parts, writes CSV and pictures to options.out, prints what was found beside what
/// the paper says. A part that cannot be had here (no display for `speed`) is named and left out.
/// @return an exit code of core/error.h, or kExitStopped: what was finished stays
int run_paper(const PaperOptions& options, std::ostream& out, std::ostream& log);

}  // namespace palpate::paper
