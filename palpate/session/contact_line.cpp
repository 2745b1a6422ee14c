#include "palpate/session/contact_line.h"

#include <spdlog/fmt/fmt.h>

namespace palpate::session {

std::string contact_line(const ContactTroubles& troubles) {
  return fmt::format(
      "contacts: {} searches truncated, {} with a probe inside without contact, {} steps not "
      "solved",
      troubles.truncated, troubles.lost, troubles.unsolved);
}

}  // namespace palpate::session
