#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

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
  /// Signs it anew, valid for no time at all, and waits until that has passed.
  void Expire(const std::string& name, const std::string& authority, const std::string& alternative) const {
    const std::string request = folder_ + "/" + name + ".csr";
    Run({"req", "-new", "-key", Key(name), "-subj", "/CN=" + name, "-addext", "subjectAltName=" + alternative,
         "-out", request});
    Run({"x509", "-req", "-in", request, "-CA", Certificate(authority), "-CAkey", Key(authority),
         "-set_serial", "2", "-days", "0", "-copy_extensions", "copy", "-out", Certificate(name)});
    std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  }

 private:
  void Make(const std::string& name, const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"req",     "-x509",       "-newkey",
                                      "ec",      "-pkeyopt",    "ec_paramgen_curve:prime256v1",
                                      "-noenc",  "-days",       "1",
                                      "-subj",   "/CN=" + name, "-keyout",
                                      Key(name), "-out",        Certificate(name)};
    words.insert(words.end(), more.begin(), more.end());
    Run(words);
  }
  static void Run(const std::vector<std::string>& words) {
    Program openssl;
    openssl.Start("openssl", words, "/dev/null");
    ASSERT_EQ(openssl.Wait(), 0) << "openssl cannot " << words.front() << " " << words.back();
  }

  std::string folder_;
};

}  // namespace hydroscope
