#include "studies/certify/line.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace palpate::certify {
namespace {

Line judged(const std::string& group, const Measured& m, bool at_least) {
  const bool holds = at_least ? m.value >= m.limit : m.value <= m.limit;
  const bool pass = std::isfinite(m.value) && holds;
  return {group,    m.name,   m.value,
          m.limit,  at_least, m.unit,
          m.source, m.note,   pass ? Verdict::kPass : Verdict::kFail};
}

}  // namespace

const char* word_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kFail:
      return "FAIL";
    case Verdict::kNotMeasured:
      break;
  }
  return "not measured";
}

Line at_most(const std::string& group, const Measured& measured) {
  return judged(group, measured, false);
}

Line at_least(const std::string& group, const Measured& measured) {
  return judged(group, measured, true);
}

Line not_measured(const std::string& group, const std::string& name, const std::string& reason) {
  Line line;
  line.group = group;
  line.name = name;
  line.note = reason;
  return line;
}

std::string text_of(const Line& line) {
  const std::string what = fmt::format("{}: {}: ", line.group, line.name);
  if (line.verdict == Verdict::kNotMeasured) return what + "not measured, " + line.note;
  const std::string unit = line.unit.empty() ? "" : " " + line.unit;
  const std::string why = std::isfinite(line.value) || line.note.empty() ? "" : ", " + line.note;
  return fmt::format("{}{:.4g}{}, {} {:.4g}{}: {}{}", what, line.value, unit,
                     line.at_least ? "at least" : "at most", line.limit, unit,
                     word_of(line.verdict), why);
}

bool any_failed(const std::vector<Line>& lines) {
  return std::any_of(lines.begin(), lines.end(),
                     [](const Line& line) { return line.verdict == Verdict::kFail; });
}

}  // namespace palpate::certify
