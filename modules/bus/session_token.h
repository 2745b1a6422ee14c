// What the samples of one session bear, and no others: programs that meet by accident, under the
// same name or by a partition "*", do not believe each other. It travels in the clear, so it keeps
// out mistakes; who means harm is kept out by keys alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace palpate::bus {

/// @throws InputError for a domain or a name that no session can have
void check_session(int domain, const std::string& session);

/// PALPATE_TOKEN of the environment, 1 to 16 hex digits, if it is set. Else made of domain, session
/// and the user's secret on this host: the same for all his programs, whatever starts first.
/// @throws InputError as check_session(), for another PALPATE_TOKEN, or if there can be no secret
std::uint64_t session_token(int domain, const std::string& session);

/// As PALPATE_TOKEN is written: 16 hex digits.
std::string token_text(std::uint64_t token);

/// The user's secret: 32 random bytes in a file that nobody else may read, made by whoever asks
/// first.
/// @throws InputError if it cannot be made or is not the user's own
std::string user_secret(const std::filesystem::path& file);
/// $XDG_RUNTIME_DIR/palpate.secret, else in /run/user/UID, else /tmp/palpate-UID.secret.
std::filesystem::path user_secret_file();

}  // namespace palpate::bus
