// Messages as rows of tables: the columns are the described fields, their unit as suffix.
#pragma once

#include <iosfwd>
#include <string>

#include "modules/messages/message_types.h"

namespace palpate::messages {

/// The shortest text that reads back as the same number; "nan", "inf".
void write_number(std::ostream& stream, double value);

/// Nanoseconds as seconds, exact to the nanosecond up to 100 days.
void write_seconds(std::ostream& stream, std::int64_t ns);

/// The text in quotes where it holds a comma, a quote or a line end.
std::string csv_text(const std::string& text);

/// "force_x_n" for part "x" of "force_n", "normal_x" of "normal".
std::string name_of_part(std::string_view field, std::string_view part);

/// Comma-separated names and values, without header and key: parts of vectors each in a column of
/// its own, of lists the number of entries, no long texts.
std::string csv_columns(const AnyMessage& message);
void write_csv_values(std::ostream& stream, const AnyMessage& message);
std::string csv_columns(const ModuleStatus::Input& input);
void write_csv_values(std::ostream& stream, const ModuleStatus::Input& input);

/// "0" for probe or organ 0, "haptics" for a module; empty for a message without key.
std::string key_text(const AnyMessage& message);

const Header& header_of(const AnyMessage& message);

}  // namespace palpate::messages
