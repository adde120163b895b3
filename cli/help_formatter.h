#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>

#include "host/output.h"

namespace hydroscope {

/// Prose and examples under the help of a command, in lines of at most `width` characters: lines of prose are filled, those
/// that begin with a blank stay as they are, but that commands to be copied go on in the next line behind a backslash.
std::string FilledFooter(const std::string& text, std::size_t width);

/// Help in lines that fit the terminal; descriptions continue in their column.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override;
  std::string make_footer(const CLI::App* app) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_expanded(const CLI::App* command) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;

 private:
  /// A description as wide as what the column of names leaves.
  std::string Described(const std::string& text) const;
  mutable std::size_t width_ = LineWidth();
};

}  // namespace hydroscope
