// What went wrong with contacts, in words: the same line in every summary.
#pragma once

#include <string>

#include "modules/messages/messages.h"

namespace palpate::session {

/// "contacts: 0 searches truncated, …"
std::string contact_line(const ContactTroubles& troubles);

}  // namespace palpate::session
