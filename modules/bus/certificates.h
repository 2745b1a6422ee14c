// Certificates and signatures by OpenSSL: elliptic keys (P-256), SHA-256.
#pragma once

#include <openssl/types.h>

#include <chrono>
#include <memory>
#include <string>

namespace palpate::bus {

using WallTime = std::chrono::sys_seconds;

struct Validity {
  WallTime from, to;
};
Validity valid_from_now(std::chrono::seconds how_long);
std::string text_of(WallTime time);  ///< "2026-11-23T21:05:00Z"
/// The subject of an identity's certificate, as permissions name it.
std::string subject_of(const std::string& name);

/// As PEM.
struct Identity {
  std::string key, certificate;
};

/// Signs identities and documents, as long as it lives: its key is nowhere else.
/// @throws std::runtime_error what OpenSSL says, in all that it does
class Authority {
 public:
  explicit Authority(const Validity& validity);
  ~Authority();
  Authority(const Authority&) = delete;
  Authority& operator=(const Authority&) = delete;

  std::string certificate() const;  ///< its own, as PEM
  Identity identity(const std::string& name, const Validity& validity) const;
  std::string signed_text(const std::string& text) const;  ///< S/MIME, text and signature

 private:
  std::shared_ptr<EVP_PKEY> key_;
  std::shared_ptr<X509> certificate_;
};

}  // namespace palpate::bus
