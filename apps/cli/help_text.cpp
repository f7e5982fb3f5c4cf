#include "apps/cli/help_text.hpp"

#include <algorithm>

#include <unistd.h>

#include "apps/cli/terminal.hpp"
#include "apps/cli/wrapping.hpp"

namespace groundloop::apps {
namespace {

constexpr std::size_t kWidest = 100;  // longer lines are hard to read
constexpr std::size_t kColumn = 28;

class Text {
 public:
  Text(std::size_t width, bool coloured) : width_(width), coloured_(coloured) {}

  void heading(const std::string& title) { text_ += "\n" + bold(title, coloured_) + "\n"; }
  void paragraph(const std::string& words) {
    for (const std::string& line : wrapped(words, width_)) text_ += line + "\n";
  }
  void row(const std::string& left, const std::string& right) {
    text_ += two_columns(left, right, kColumn, width_);
  }
  void options(const std::string& title, const std::vector<OptionPage>& options) {
    if (options.empty()) return;
    heading(title);
    for (const OptionPage& option : options) row(option_label(option), option_text(option));
  }
  // A command is for copying: never broken.
  void example(const Example& example) {
    text_ += "  " + example.command + "\n";
    for (const std::string& line : wrapped(example.purpose, width_ - 6))
      text_ += "      " + line + "\n";
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::size_t width_;
  bool coloured_;
  std::string text_;
};

// Sentences of their own, though the parser's descriptions begin small.
std::string sentence(std::string words) {
  if (words.empty()) return words;
  words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
  if (words.back() != '.') words += '.';
  return words;
}

class HelpFormatter final : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string /*name*/,
                        CLI::AppFormatMode /*mode*/) const override {
    const auto columns = static_cast<std::size_t>(terminal_columns(STDOUT_FILENO));
    return help_text(page_of(*app), std::min(columns, kWidest), shows_colours(STDOUT_FILENO));
  }
};

}  // namespace

std::string option_label(const OptionPage& option) {
  const std::string dots = option.repeats ? "..." : "";
  if (option.name.front() != '-') return option.name + dots;
  return option.value.name.empty() ? option.name : option.name + " " + option.value.name + dots;
}

std::string option_text(const OptionPage& option) {
  std::string text = option.description;
  if (!option.limits.empty()) text += ", in " + option.limits;
  if (!option.fallback.empty()) text += " (default " + option.fallback + ")";
  if (option.required && option.name.front() == '-') text += " (required)";
  return text;
}

std::string usage_line(const CommandPage& page) {
  std::string line = page.path;
  for (const OptionPage& argument : page.arguments) {
    const std::string label = option_label(argument);
    line += argument.required ? " " + label : " [" + label + "]";
  }
  bool optional = false;
  for (const OptionPage& option : page.options) {
    if (option.required)
      line += " " + option_label(option);
    else
      optional = true;
  }
  if (optional) line += " [OPTIONS]";
  if (!page.commands.empty()) line += " COMMAND ...";
  return line;
}

std::string help_text(const CommandPage& page, std::size_t width, bool coloured) {
  Text text(width, coloured);
  text.paragraph(usage_line(page));
  text.paragraph("");
  text.paragraph(sentence(page.summary) + " " + page.guide.about);
  if (!page.guide.examples.empty()) {
    text.heading(page.guide.examples.size() == 1 ? "Example" : "Examples");
    for (const Example& example : page.guide.examples) text.example(example);
  }
  if (!page.commands.empty()) {
    text.heading("Commands");
    for (const CommandName& command : page.commands) text.row(command.name, command.summary);
  }
  text.options("Arguments", page.arguments);
  text.options("Options", page.options);
  text.options("Options of every command", page.everywhere);
  if (!page.guide.files.empty()) {
    text.heading("Writes");
    for (const WrittenFile& file : page.guide.files) text.row(file.name, file.what);
  }
  return text.text();
}

std::shared_ptr<CLI::FormatterBase> help_formatter() { return std::make_shared<HelpFormatter>(); }

}  // namespace groundloop::apps
