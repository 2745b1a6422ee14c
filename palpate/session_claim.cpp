#include "palpate/session_claim.h"

#include <spdlog/fmt/fmt.h>

#include "modules/core/error.h"

namespace palpate::launcher {
namespace {

/// The module first: a name may be cut.
std::string claim_name(const std::string& session, int domain, const std::string& module) {
  return fmt::format("palpate-{}-{}-{}", module, domain, session);
}

[[noreturn]] void refuse_module(const std::string& session, const std::string& module) {
  throw InputError(
      fmt::format("session '{}' has {} here already: end that, give this one another --session, "
                  "or join with --only and what it lacks",
                  session, module));
}

}  // namespace

SessionClaim::SessionClaim(const std::string& session, int domain,
                           const std::vector<std::string>& modules)
    : SessionClaim() {  // so that it is given back where the modules are not free
  auto whole = runtime::NameClaim::take(fmt::format("palpate-{}-{}", domain, session));
  if (!whole) {
    throw InputError(fmt::format(
        "session '{}' already runs here: end it, give this one another --session, or join with "
        "--only MODULE",
        session));
  }
  names_.emplace("", std::move(*whole));
  names_.merge(joining(session, domain, modules).names_);
}

SessionClaim SessionClaim::joining(const std::string& session, int domain,
                                   const std::vector<std::string>& modules) {
  SessionClaim claim;
  for (const auto& module : modules) {
    if (runtime::may_be_several(module)) continue;
    auto own = runtime::NameClaim::take(claim_name(session, domain, module));
    if (!own) refuse_module(session, module);
    claim.names_.emplace(module, std::move(*own));
  }
  // Processes that somebody started by hand; its own will claim what is given back here.
  for (const auto& module : modules) runtime::claim_module({domain, session}, module);
  return claim;
}

void SessionClaim::release(const std::string& module) { names_.erase(module); }

}  // namespace palpate::launcher
