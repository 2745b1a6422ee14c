#include "modules/bus/certificates.h"

#include <openssl/pem.h>
#include <openssl/x509.h>

#include <catch2/catch.hpp>

namespace palpate::bus {
namespace {

std::shared_ptr<X509> read(const std::string& pem) {
  BIO* const bio = BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size()));
  std::shared_ptr<X509> certificate(PEM_read_bio_X509(bio, nullptr, nullptr, nullptr), X509_free);
  BIO_free(bio);
  REQUIRE(certificate != nullptr);
  return certificate;
}

bool signed_by(const std::string& certificate, const Authority& authority) {
  const auto issuer = read(authority.certificate());
  return X509_verify(read(certificate).get(), X509_get0_pubkey(issuer.get())) == 1;
}

}  // namespace

TEST_CASE("certificates: an identity is signed by its authority and by no other", "[bus]") {
  // Oracle: OpenSSL's verification.
  const Validity hour = valid_from_now(std::chrono::hours(1));
  const Authority authority(hour), another(hour);
  const Identity identity = authority.identity("haptics", hour);
  CHECK(signed_by(identity.certificate, authority));
  CHECK_FALSE(signed_by(identity.certificate, another));
  CHECK(signed_by(authority.certificate(), authority));
}

TEST_CASE("certificates: they hold from a little before now to their end", "[bus]") {
  // Oracle: OpenSSL's comparison with the clock, now and at both ends.
  const Validity hour = valid_from_now(std::chrono::hours(1));
  const auto certificate = read(Authority(hour).certificate());
  const auto from = hour.from.time_since_epoch().count(), to = hour.to.time_since_epoch().count();
  CHECK(ASN1_TIME_cmp_time_t(X509_get0_notBefore(certificate.get()), from) == 0);
  CHECK(ASN1_TIME_cmp_time_t(X509_get0_notAfter(certificate.get()), to) == 0);
  CHECK(X509_cmp_current_time(X509_get0_notBefore(certificate.get())) < 0);
  CHECK(X509_cmp_current_time(X509_get0_notAfter(certificate.get())) > 0);
}

TEST_CASE("certificates: times are written as permissions want them", "[bus]") {
  // Oracle: a day by hand.
  CHECK(text_of(WallTime(std::chrono::seconds(1'000'000'000))) == "2001-09-09T01:46:40Z");
}

}  // namespace palpate::bus
