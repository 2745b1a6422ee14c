// What was measured, beside what the paper says.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace palpate::paper {

struct Finding {
  std::string figure;    ///< "Figure 2"
  std::string quantity;  ///< with its unit
  std::string paper;     ///< what the paper says; empty if it says nothing we know of
  std::string measured;
};

using Findings = std::vector<Finding>;

void print(const Findings& findings, std::ostream& out);
/// One row each: figure, quantity, paper, measured.
void write(const Findings& findings, const std::filesystem::path& file);

}  // namespace palpate::paper
