// The texts of idl/, which recordings carry as schemas.
#pragma once

#include <string_view>

#include "modules/messages/message_types.h"

namespace palpate::recording {

/// Of idl/ProbeState.idl for the type of ProbeState, comments included.
std::string_view idl_text_of(const messages::MessageType& type);

/// True if both texts define the same types: comments and white space do not count.
bool same_idl(std::string_view a, std::string_view b);

}  // namespace palpate::recording
