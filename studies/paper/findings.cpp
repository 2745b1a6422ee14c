#include "studies/paper/findings.h"

#include <algorithm>
#include <iomanip>
#include <ostream>

#include "studies/report/table_file.h"

namespace palpate::paper {

void print(const Findings& findings, std::ostream& out) {
  std::size_t width = 0;
  for (const auto& finding : findings) width = std::max(width, finding.quantity.size());
  for (const auto& finding : findings) {
    out << std::left << std::setw(10) << finding.figure << std::setw(static_cast<int>(width) + 2)
        << finding.quantity << finding.measured;
    if (!finding.paper.empty()) out << "   (paper: " << finding.paper << ')';
    out << '\n';
  }
}

void write(const Findings& findings, const std::filesystem::path& file) {
  report::TableFile table(file, {"figure", "quantity", "paper", "measured"});
  for (const auto& finding : findings) {
    table.write_row({finding.figure, finding.quantity, finding.paper, finding.measured});
  }
  table.finish();
}

}  // namespace palpate::paper
