// Whether what a recording says of its types and topics is what this version means by them.
#pragma once

#include <string>

#include "modules/recording/mcap_records.h"

namespace palpate::recording {

/// Of a translation (foxglove_export.h), which no reader of samples takes.
bool is_translation(const std::string& type);

/// One line; empty if it is one of Palpate's or a translation.
std::string why_foreign(const McapSchema& schema);
/// @param type  name of its schema; empty: it has none
std::string why_foreign(const McapChannel& channel, const std::string& type);

}  // namespace palpate::recording
