#include "modules/bus/certificates.h"

#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <array>
#include <ctime>
#include <stdexcept>

namespace palpate::bus {
namespace {

constexpr const char* kAuthorityName = "Palpate session";
constexpr int kSerialBits = 64;
constexpr long kX509v3 = 2;  // versions count from 0

template <class T>
T* demand(T* made, const char* what) {
  if (made != nullptr) return made;
  std::array<char, 256> why{};
  ERR_error_string_n(ERR_get_error(), why.data(), why.size());
  throw std::runtime_error(std::string("OpenSSL: ") + what + ": " + why.data());
}
void demand(bool done, const char* what) {
  static char something;
  demand(done ? &something : nullptr, what);
}

using Bio = std::unique_ptr<BIO, decltype(&BIO_free_all)>;
Bio memory() { return {demand(BIO_new(BIO_s_mem()), "memory"), BIO_free_all}; }
Bio memory(const std::string& text) {
  return {demand(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), "memory"),
          BIO_free_all};
}
std::string text_in(const Bio& bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &data);
  return {data, static_cast<std::size_t>(size)};
}

std::shared_ptr<EVP_PKEY> new_key() { return {demand(EVP_EC_gen("P-256"), "key"), EVP_PKEY_free}; }

void name(X509_NAME* subject, const std::string& text) {
  // By a pointer to bytes: they are the characters.
  const auto* const bytes = reinterpret_cast<const unsigned char*>(text.data());
  demand(X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8, bytes,
                                    static_cast<int>(text.size()), -1, 0) == 1,
         "name");
}

void add_serial(X509* certificate) {
  const std::unique_ptr<BIGNUM, decltype(&BN_free)> number(demand(BN_new(), "number"), BN_free);
  demand(BN_rand(number.get(), kSerialBits, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1, "number");
  demand(BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)), "number");
}

/// Not signed yet.
std::shared_ptr<X509> new_certificate(const std::string& subject, EVP_PKEY* key,
                                      const Validity& validity) {
  const std::shared_ptr<X509> certificate(demand(X509_new(), "certificate"), X509_free);
  X509_set_version(certificate.get(), kX509v3);
  add_serial(certificate.get());
  ASN1_TIME_set(X509_getm_notBefore(certificate.get()), validity.from.time_since_epoch().count());
  ASN1_TIME_set(X509_getm_notAfter(certificate.get()), validity.to.time_since_epoch().count());
  name(X509_get_subject_name(certificate.get()), subject);
  demand(X509_set_pubkey(certificate.get(), key) == 1, "certificate");
  return certificate;
}

void sign(X509* certificate, const X509* issuer, EVP_PKEY* key) {
  demand(X509_set_issuer_name(certificate, X509_get_subject_name(issuer)) == 1, "issuer");
  demand(X509_sign(certificate, key, EVP_sha256()) > 0, "signature");
}

void say_authority(X509* certificate) {
  X509_EXTENSION* const extension =
      demand(X509V3_EXT_conf_nid(nullptr, nullptr, NID_basic_constraints, "critical,CA:TRUE"),
             "extension");
  const int added = X509_add_ext(certificate, extension, -1);
  X509_EXTENSION_free(extension);
  demand(added == 1, "extension");
}

std::string pem(X509* certificate) {
  const Bio out = memory();
  demand(PEM_write_bio_X509(out.get(), certificate) == 1, "certificate");
  return text_in(out);
}

std::string pem(EVP_PKEY* key) {
  const Bio out = memory();
  demand(PEM_write_bio_PrivateKey(out.get(), key, nullptr, nullptr, 0, nullptr, nullptr) == 1,
         "key");
  return text_in(out);
}

}  // namespace

Validity valid_from_now(std::chrono::seconds how_long) {
  using namespace std::chrono;
  // From a little before: clocks of two hosts differ.
  const WallTime now = floor<seconds>(system_clock::now());
  return {now - minutes(5), now + how_long};
}

std::string text_of(WallTime time) {
  const std::time_t seconds = time.time_since_epoch().count();
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return {text.data(), size};
}

std::string subject_of(const std::string& name) { return "CN=" + name; }

Authority::Authority(const Validity& validity)
    : key_(new_key()), certificate_(new_certificate(kAuthorityName, key_.get(), validity)) {
  say_authority(certificate_.get());
  sign(certificate_.get(), certificate_.get(), key_.get());
}

Authority::~Authority() = default;

std::string Authority::certificate() const { return pem(certificate_.get()); }

Identity Authority::identity(const std::string& name, const Validity& validity) const {
  const auto key = new_key();
  const auto certificate = new_certificate(name, key.get(), validity);
  sign(certificate.get(), certificate_.get(), key_.get());
  return {pem(key.get()), pem(certificate.get())};
}

std::string Authority::signed_text(const std::string& text) const {
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED;
  const Bio in = memory(text), again = memory(text), out = memory();
  const std::unique_ptr<PKCS7, decltype(&PKCS7_free)> signature(
      demand(PKCS7_sign(certificate_.get(), key_.get(), nullptr, in.get(), kFlags), "signature"),
      PKCS7_free);
  demand(SMIME_write_PKCS7(out.get(), signature.get(), again.get(), kFlags) == 1, "signature");
  return text_in(out);
}

}  // namespace palpate::bus
