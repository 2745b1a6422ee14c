// A name that one program of a host has at a time.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <string_view>

#include "modules/bus/bus.h"

namespace palpate::runtime {

/// Held as long as this object lives, and given back by the kernel should the program die, before
/// anybody hears of that. Nothing is left on disk: it is the name of an abstract socket.
class NameClaim {
 public:
  /// None if another program has the name. One too long is cut: two that begin with the same
  /// hundred characters count as one.
  /// @throws std::runtime_error naming it if the system gives no socket
  static std::optional<NameClaim> take(const std::string& name);
  /// The program that has it; 0: it does not say.
  static pid_t holder(const std::string& name);

  ~NameClaim();
  NameClaim(NameClaim&& other) noexcept;
  NameClaim& operator=(NameClaim&& other) noexcept;
  NameClaim(const NameClaim&) = delete;
  NameClaim& operator=(const NameClaim&) = delete;

 private:
  explicit NameClaim(int socket) : socket_(socket) {}
  int socket_;  ///< -1: given away
};

/// So long a process that ends keeps its successor waiting: a launcher that was killed needs a
/// second until who hangs is killed [s].
inline constexpr double kPredecessorEndsWithin = 3;

/// Of which a session may have several: a viewer, a recorder.
bool may_be_several(std::string_view module);

/// What claim_module() takes: a name of the user's.
std::string process_name(const bus::BusOptions& session, const std::string& module);

/// A process is this module of this session, and no other one of its user and host is. Two would
/// both tell where the organs are, or what a hand feels, and what is felt would jump between them.
/// None for those of which there may be several.
/// @throws InputError naming session, module and the process that is it, if that does not end
/// within kPredecessorEndsWithin; Interrupted if a signal of StopSignal comes
std::optional<NameClaim> claim_module(const bus::BusOptions& session, const std::string& module);

}  // namespace palpate::runtime
