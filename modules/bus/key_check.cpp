#include "modules/bus/key_check.h"

#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <string>

#include "modules/bus/certificates.h"
#include "modules/bus/roles.h"
#include "modules/core/error.h"
#include "modules/core/input_file.h"

namespace palpate::bus {
namespace {

namespace fs = std::filesystem;

using Bio = std::unique_ptr<BIO, decltype(&BIO_free_all)>;
using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

constexpr const char* kMakeNew = "; `palpate keys` makes new ones";
constexpr const char* kCopyAll =
    "; copy authority.pem, governance.p7s and the role's three files"
    " from one folder of `palpate keys`";

[[noreturn]] void refuse(const fs::path& file, const std::string& what, const char* advice) {
  throw InputError("keys: " + file.string() + ": " + what + advice);
}

/// As ssh does: whoever may write there could put an authority of his own beside or in its place.
void check_unwritable(const fs::path& place) {
  constexpr fs::perms kOthers = fs::perms::group_write | fs::perms::others_write;
  std::error_code none;
  const fs::file_status status = fs::status(place, none);
  if (!fs::exists(status) || (status.permissions() & kOthers) == fs::perms::none) return;
  refuse(place, "others may write to it", "; chmod go-w it, and make new keys if they did");
}

Bio opened(const fs::path& file) {
  std::error_code none;
  const bool is_there = fs::exists(file, none);
  if (is_there && !fs::is_regular_file(file, none)) refuse(file, "is no regular file", kCopyAll);
  if (const std::string why = why_not_readable(file); !why.empty())
    refuse(file, why, is_there ? "" : "; `palpate keys` makes them");
  Bio bio(BIO_new_file(file.c_str(), "r"), BIO_free_all);
  if (bio == nullptr) refuse(file, std::strerror(errno), "");
  return bio;
}

Certificate certificate_in(const fs::path& file) {
  const Bio bio = opened(file);
  Certificate certificate(PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr), X509_free);
  if (certificate == nullptr) refuse(file, "is no certificate", kCopyAll);
  return certificate;
}

/// Asks nobody for a password.
int no_password(char*, int, int, void*) { return 0; }

/// As ssh does: whoever read it could be of this session, and nobody would know.
void check_private(const fs::path& file) {
  constexpr fs::perms kOthers = fs::perms::group_all | fs::perms::others_all;
  std::error_code none;
  if ((fs::status(file, none).permissions() & kOthers) == fs::perms::none) return;
  refuse(file, "others may read or write it", "; chmod 600 it, and make new keys if they did");
}

Key key_in(const fs::path& file) {
  const Bio bio = opened(file);
  check_private(file);
  Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_password, nullptr), EVP_PKEY_free);
  if (key == nullptr) refuse(file, "is no key", kCopyAll);
  return key;
}

void check_time(const fs::path& file, const std::string& from, const std::string& to) {
  // Times as certificates and permissions have them are ordered as their texts are.
  const std::string now =
      text_of(std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()));
  if (now < from) refuse(file, "holds from " + from + " on: is this host's clock right?", "");
  if (now > to) refuse(file, "expired at " + to, kMakeNew);
}

std::string utc_of(const ASN1_TIME* time) {
  std::tm parts{};
  if (ASN1_TIME_to_tm(time, &parts) != 1) return "";
  return text_of(WallTime(std::chrono::seconds(::timegm(&parts))));
}

void check_time(const fs::path& file, const X509* certificate) {
  check_time(file, utc_of(X509_get0_notBefore(certificate)),
             utc_of(X509_get0_notAfter(certificate)));
}

std::string name_of(const X509* certificate) {
  char name[256] = "";
  X509_NAME_get_text_by_NID(X509_get_subject_name(certificate), NID_commonName, name, sizeof name);
  return name;
}

/// @returns what was signed
std::string signed_text_in(const fs::path& file, X509* authority) {
  const Bio in = opened(file), out(BIO_new(BIO_s_mem()), BIO_free_all);
  BIO* content = nullptr;
  const std::unique_ptr<PKCS7, decltype(&PKCS7_free)> signature(
      SMIME_read_PKCS7(in.get(), &content), PKCS7_free);
  const Bio text(content, BIO_free_all);
  const std::unique_ptr<STACK_OF(X509), void (*)(STACK_OF(X509)*)> only(
      sk_X509_new_null(), [](STACK_OF(X509) * certificates) { sk_X509_free(certificates); });
  sk_X509_push(only.get(), authority);
  // By the authority's key and no other; its own time is checked apart.
  constexpr int kFlags = PKCS7_NOINTERN | PKCS7_NOVERIFY | PKCS7_TEXT;
  const bool is_signed = signature != nullptr && PKCS7_verify(signature.get(), only.get(), nullptr,
                                                              text.get(), out.get(), kFlags) == 1;
  if (!is_signed) refuse(file, "is not signed by the authority.pem beside it", kCopyAll);
  char* data = nullptr;
  const long size = BIO_get_mem_data(out.get(), &data);
  return {data, static_cast<std::size_t>(size)};
}

/// Between <name> and </name>, where it comes first.
std::string element(const std::string& xml, const std::string& name) {
  const auto begin = xml.find("<" + name + ">");
  const auto end = xml.find("</" + name + ">");
  if (begin == std::string::npos || end == std::string::npos) return "";
  const auto from = begin + name.size() + 2;
  return end < from ? "" : xml.substr(from, end - from);
}

void check_certificate(const KeyFiles& files, std::string_view role, X509* authority) {
  const Certificate own = certificate_in(files.certificate);
  const Key key = key_in(files.key);
  if (X509_verify(own.get(), X509_get0_pubkey(authority)) != 1)
    refuse(files.certificate, "is not signed by the authority.pem beside it", kCopyAll);
  if (name_of(own.get()) != role)
    refuse(files.certificate, "is of role " + name_of(own.get()), kCopyAll);
  if (X509_check_private_key(own.get(), key.get()) != 1)
    refuse(files.key, "is not the key of " + files.certificate.filename().string(), kCopyAll);
  check_time(files.certificate, own.get());
}

void check_permissions(const KeyFiles& files, std::string_view role, X509* authority) {
  const std::string permissions = signed_text_in(files.permissions, authority);
  const std::string subject = element(permissions, "subject_name");
  if (subject != subject_of(std::string(role)))
    refuse(files.permissions, "is of '" + subject + "'", kCopyAll);
  check_time(files.permissions, element(permissions, "not_before"),
             element(permissions, "not_after"));
}

}  // namespace

KeyFiles key_files(const fs::path& folder, std::string_view role) {
  const std::string name(role);
  return {folder / "authority.pem", folder / "governance.p7s", folder / (name + ".pem"),
          folder / (name + ".key"), folder / (name + ".p7s")};
}

void check_keys(const fs::path& folder, std::string_view role) {
  if (find_role(role) == nullptr)
    throw InputError("keys: there is no role '" + std::string(role) + "'");
  const KeyFiles files = key_files(folder, role);
  check_unwritable(folder);
  for (const fs::path& file :
       {files.authority, files.governance, files.certificate, files.permissions}) {
    check_unwritable(file);
  }
  const Certificate authority = certificate_in(files.authority);
  check_time(files.authority, authority.get());
  check_certificate(files, role, authority.get());
  signed_text_in(files.governance, authority.get());
  check_permissions(files, role, authority.get());
}

}  // namespace palpate::bus
