#include "apps/cli/man_page.hpp"

#include <algorithm>

#include "apps/cli/help_text.hpp"

namespace groundloop::apps {
namespace {

// Plain text for roff: no escapes of its own, hyphens that can be copied, and no dot or quote at
// the beginning of a line, where they would be requests.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else if ((c == '.' || c == '\'') && out.empty()) {
      out += std::string("\\&") + c;
    } else {
      out += c;
    }
  }
  return out;
}

std::string bold_roff(const std::string& text) { return "\\fB" + plain(text) + "\\fR"; }

std::string joined(const std::string& path) {
  std::string name = path;
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string label_roff(const OptionPage& option) {
  const std::string label = option_label(option);
  const std::size_t space = label.find(' ');
  if (space == std::string::npos) return bold_roff(label);
  return bold_roff(label.substr(0, space)) + " \\fI" + plain(label.substr(space + 1)) + "\\fR";
}

void add_options(std::string& page, const std::string& title,
                 const std::vector<OptionPage>& options) {
  if (options.empty()) return;
  page += ".SH " + title + "\n";
  for (const OptionPage& option : options)
    page += ".TP\n" + label_roff(option) + "\n" + plain(option_text(option)) + "\n";
}

void add_examples(std::string& page, const std::vector<Example>& examples) {
  if (examples.empty()) return;
  page += ".SH EXAMPLES\n";
  for (const Example& example : examples) {
    page += ".PP\n" + plain(example.purpose) + ":\n.PP\n.RS 4\n.nf\n" + plain(example.command) +
            "\n.fi\n.RE\n";
  }
}

void add_files(std::string& page, const std::vector<WrittenFile>& files) {
  if (files.empty()) return;
  page += ".SH FILES\nWritten:\n";
  for (const WrittenFile& file : files)
    page += ".TP\n" + bold_roff(file.name) + "\n" + plain(file.what) + "\n";
}

void add_exit_codes(std::string& page) {
  page +=
      ".SH EXIT STATUS\n.TP\n.B 0\nthe work is done\n.TP\n.B 1\nan internal check failed\n.TP\n"
      ".B 2\ninput or usage is wrong; one line on standard error says what and what would mend it\n"
      ".TP\n.B 130\ninterrupted; what was begun can be resumed where the command knows "
      "\\fB\\-\\-resume\\fR\n";
}

// The command above it, and those below.
void add_see_also(std::string& page, const CommandPage& command) {
  std::vector<std::string> names;
  if (const std::size_t space = command.path.find_last_of(' '); space != std::string::npos)
    names.push_back(joined(command.path.substr(0, space)));
  for (const CommandName& below : command.commands)
    names.push_back(joined(command.path + " " + below.name));
  if (names.empty()) return;
  page += ".SH SEE ALSO\n";
  for (std::size_t i = 0; i < names.size(); ++i)
    page += (i == 0 ? "" : ",\n") + bold_roff(names[i]) + "(1)";
  page += "\n";
}

}  // namespace

std::string man_page_name(const CommandPage& page) { return joined(page.path) + ".1"; }

std::string man_page(const CommandPage& page) {
  const std::string name = joined(page.path);
  std::string upper = name;
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::string roff =
      ".TH \"" + upper +
      "\" \"1\" \"\" \"groundloop " GROUNDLOOP_VERSION "\" \"groundloop\"\n.SH NAME\n" +
      plain(name) + " \\- " + plain(page.summary) + "\n.SH SYNOPSIS\n" + bold_roff(page.path) +
      plain(usage_line(page).substr(page.path.size())) + "\n.SH DESCRIPTION\n" +
      plain(page.guide.about.empty() ? page.summary : page.guide.about) + "\n";
  add_examples(roff, page.guide.examples);
  if (!page.commands.empty()) {
    roff += ".SH COMMANDS\n";
    for (const CommandName& below : page.commands)
      roff += ".TP\n" + bold_roff(below.name) + "\n" + plain(below.summary) + "\n";
  }
  add_options(roff, "ARGUMENTS", page.arguments);
  add_options(roff, "OPTIONS", page.options);
  add_options(roff, "\"OPTIONS OF EVERY COMMAND\"", page.everywhere);
  add_files(roff, page.guide.files);
  add_exit_codes(roff);
  add_see_also(roff, page);
  return roff;
}

}  // namespace groundloop::apps
