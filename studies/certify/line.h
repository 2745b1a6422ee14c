// A line of a certificate: a number, its limit and where the limit comes from.
#pragma once

#include <string>
#include <vector>

namespace palpate::certify {

enum class Verdict { kPass, kFail, kNotMeasured };
const char* word_of(Verdict verdict);  ///< "pass", "FAIL", "not measured"

struct Line {
  std::string group, name;
  double value = 0, limit = 0;
  bool at_least = false;  ///< the value must reach the limit, else it must not exceed it
  std::string unit;       ///< of both; empty: a number
  std::string source;     ///< of the limit
  std::string note;       ///< what else was seen; of a line that was not measured, why
  Verdict verdict = Verdict::kNotMeasured;
};

/// A value with its limit.
struct Measured {
  std::string name;
  double value = 0, limit = 0;
  std::string unit, source, note;
};
// A value that is not finite fails.
Line at_most(const std::string& group, const Measured& measured);
Line at_least(const std::string& group, const Measured& measured);
Line not_measured(const std::string& group, const std::string& name, const std::string& reason);

/// "stability: critical stiffness: 392 N/m, at least 320 N/m: pass"; of what is not finite with its
/// note, which says why
std::string text_of(const Line& line);

bool any_failed(const std::vector<Line>& lines);

}  // namespace palpate::certify
