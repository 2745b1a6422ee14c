// Files of a folder that nobody knows, called what a person knows them by.
#pragma once

#include <filesystem>
#include <ostream>
#include <streambuf>
#include <string>
#include <utility>
#include <vector>

#include "modules/core/error.h"

namespace palpate::launcher {

class KnownNames {
 public:
  void add(const std::filesystem::path& file, std::string known) {
    names_.emplace_back(file.string(), std::move(known));
  }
  /// The text with each file by its name; lines of such files mean nothing and are left out.
  std::string in(std::string text) const;
  InputError in(const InputError& error) const { return InputError(in(std::string(error.what()))); }

 private:
  std::vector<std::pair<std::string, std::string>> names_;
};

/// Passes lines on, with the names in them.
class NamingStream : public std::ostream {
 public:
  /// Both outlive it.
  NamingStream(std::ostream& to, const KnownNames& names)
      : std::ostream(nullptr), buffer_(to, names) {
    rdbuf(&buffer_);
  }

 private:
  class Buffer : public std::streambuf {
   public:
    Buffer(std::ostream& to, const KnownNames& names) : to_(to), names_(names) {}
    ~Buffer() override { pass_on(); }

   protected:
    int_type overflow(int_type letter) override;
    int sync() override;

   private:
    void pass_on();

    std::ostream& to_;
    const KnownNames& names_;
    std::string line_;
  };

  Buffer buffer_;
};

}  // namespace palpate::launcher
