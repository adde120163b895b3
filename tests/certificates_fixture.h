#pragma once

#include <gtest/gtest.h>

#include "tests/broker_fixture.h"

namespace hydroscope {

/// Certificates made by openssl in a folder, valid for a day.
class Certificates {
 public:
  explicit Certificates(std::string folder) : folder_(std::move(folder)) {}

  std::string Certificate(const std::string& name) const { return folder_ + "/" + name + ".pem"; }
  std::string Key(const std::string& name) const { return folder_ + "/" + name + ".key"; }

  /// An authority that signs others.
  void MakeAuthority(const std::string& name) const {
    Make(name, {"-addext", "basicConstraints=critical,CA:TRUE"});
  }
  /// Signed by `authority`; `alternative` as in subjectAltName, "IP:127.0.0.1".
  void Make(const std::string& name, const std::string& authority, const std::string& alternative) const {
    Make(name, {"-CA", Certificate(authority), "-CAkey", Key(authority), "-addext",
                "basicConstraints=critical,CA:FALSE", "-addext", "subjectAltName=" + alternative});
  }

 private:
  void Make(const std::string& name, const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"req",     "-x509",       "-newkey",
                                      "ec",      "-pkeyopt",    "ec_paramgen_curve:prime256v1",
                                      "-noenc",  "-days",       "1",
                                      "-subj",   "/CN=" + name, "-keyout",
                                      Key(name), "-out",        Certificate(name)};
    words.insert(words.end(), more.begin(), more.end());
    Program openssl;
    openssl.Start("openssl", words, "/dev/null");
    ASSERT_EQ(openssl.Wait(), 0) << "openssl cannot make the certificate " << name;
  }

  std::string folder_;
};

}  // namespace hydroscope
