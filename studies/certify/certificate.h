// What a certificate holds, and how it is written: JSON for programs, one page for people.
#pragma once

#include <filesystem>

#include "studies/certify/line.h"
#include "studies/certify/subject.h"

namespace palpate::certify {

struct Certificate {
  std::string machine;  ///< on which times were taken; empty: none were
  /// What it leaves out: "in lockstep, --quick, only law"; empty: nothing.
  std::string scope;
  bool complete = false;  ///< within its scope
  std::vector<Line> lines;

  bool passed() const { return complete && !any_failed(lines); }
};

/// certificate.json: the same bytes for the same numbers. What is not finite is null.
void write_json(const Certificate& certificate, const Subject& subject,
                const std::filesystem::path& folder);

/// Of the tables named alone, in place of those that are there: an earlier certificate's are gone.
/// @throws std::runtime_error as report::draw_figures() does
void draw_pictures(const std::vector<std::string>& tables, const std::filesystem::path& folder);

/// certificate.html, with the pictures (certify_*.png) that the folder holds.
void write_page(const Certificate& certificate, const Subject& subject,
                const std::filesystem::path& folder);

}  // namespace palpate::certify
