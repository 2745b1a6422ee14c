// One launcher a session on a host: two of one name would conduct each other's processes.
#pragma once

#include <string>

namespace palpate::launcher {

/// Held as long as this object lives, and given back by the kernel should the program die. Nothing
/// is left on disk: it is the name of an abstract socket.
class SessionClaim {
 public:
  /// @throws InputError naming the session if another launcher of this host holds it
  SessionClaim(const std::string& session, int domain);
  ~SessionClaim();
  SessionClaim(const SessionClaim&) = delete;
  SessionClaim& operator=(const SessionClaim&) = delete;

 private:
  int socket_ = -1;
};

}  // namespace palpate::launcher
