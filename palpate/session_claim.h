// One launcher a session on a host: two of one name would conduct each other's processes. Others
// join it with modules of their own.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "modules/runtime/name_claim.h"

namespace palpate::launcher {

/// Held as long as this object lives (runtime::NameClaim).
class SessionClaim {
 public:
  /// The whole of a session, for a launcher that starts these modules.
  /// @throws InputError naming the session if another program of this host holds it, or one of the
  /// modules, or is one (runtime::claim_module()); Interrupted as that
  SessionClaim(const std::string& session, int domain, const std::vector<std::string>& modules);
  /// Modules that join it, but for those of which there may be several: a viewer, a recorder.
  static SessionClaim joining(const std::string& session, int domain,
                              const std::vector<std::string>& modules);

  /// The module has ended for good: whoever joins may bring it.
  void release(const std::string& module);

 private:
  SessionClaim() = default;
  std::map<std::string, runtime::NameClaim> names_;  ///< by module; of the session itself: ""
};

}  // namespace palpate::launcher
