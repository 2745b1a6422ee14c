// What `palpate chart` leaves: CSV files and a table in words.
#pragma once

#include <filesystem>
#include <iosfwd>

#include "studies/chart/sweep.h"

namespace palpate::chart {

/// points.csv, samples.csv, profiles.csv, reference_solutions.csv in `folder`.
/// @throws std::runtime_error if one cannot be written
void write_tables(const SweepResult& result, const std::filesystem::path& folder);

/// Every point's cost and errors, and what the reference solutions may be off by.
void print(const SweepResult& result, std::ostream& out);

}  // namespace palpate::chart
