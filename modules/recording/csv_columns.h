// Messages as rows of CSV files: columns carry their unit as suffix.
#pragma once

#include <iosfwd>
#include <string>

#include "modules/recording/recorded_topics.h"

namespace palpate::recording {

/// The shortest text that reads back as the same number; "nan", "inf".
void write_number(std::ostream& stream, double value);

/// Nanoseconds as seconds, exact to the nanosecond up to 100 days.
void write_seconds(std::ostream& stream, std::int64_t ns);

/// The text in quotes where it holds a comma, a quote or a line end.
std::string csv_text(const std::string& text);

/// "0" for probe or organ 0, "haptics" for a module; empty for a topic without key.
std::string key_of(const AnyMessage& message);

const Header& header_of(const AnyMessage& message);

/// Names of the columns of this kind of message, beyond those every file begins with.
const char* csv_columns(const AnyMessage& message);

/// One value per column, comma-separated.
void write_csv_values(std::ostream& stream, const AnyMessage& message);

/// "running"; "unknown" for a value that is none.
const char* name_of(ModuleState state);

}  // namespace palpate::recording
