// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/cli/command_list.hpp"

namespace grouser {
namespace {

std::string words_of(const OptionText& option) {
  std::string words;
  for (const std::string& name : option.names) words += (words.empty() ? "" : " ") + name;
  return words;
}

// All options of a verb on one line.
std::string options_of(const VerbText& verb) {
  std::string words;
  for (const OptionText& option : verb.options)
    if (!option.names.empty()) words += (words.empty() ? "" : " ") + words_of(option);
  return words;
}

// Inside single quotes of all three shells.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string bash_script(const std::vector<VerbText>& verbs) {
  std::string names;
  std::string cases;
  for (const VerbText& verb : verbs) {
    names += (names.empty() ? "" : " ") + verb.name;
    cases += "    " + verb.name + ") words=" + quoted(options_of(verb)) + " ;;\n";
  }
  return "# bash completion of grouser; written by `grouser completion bash`\n"
         "_grouser() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} words=\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
         "    mapfile -t COMPREPLY < <(compgen -W " +
         quoted(names + " --help --version") +
         " -- \"$word\")\n"
         "    return\n"
         "  fi\n"
         "  case ${COMP_WORDS[1]} in\n" +
         cases +
         "  esac\n"
         "  if [[ $word == -* ]]; then\n"
         "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
         "  else\n"
         "    mapfile -t COMPREPLY < <(compgen -f -- \"$word\")\n"
         "  fi\n"
         "}\n"
         "complete -o filenames -F _grouser grouser\n";
}

// Brackets and colons are zsh's own in descriptions.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '[' || c == ']' || c == ':' ? ' ' : c;
  return out;
}

std::string zsh_script(const std::vector<VerbText>& verbs) {
  std::string text =
      "#compdef grouser\n# zsh completion of grouser; written by `grouser completion zsh`\n"
      "local -a verbs\nverbs=(\n";
  for (const VerbText& verb : verbs)
    text += "  " + quoted(verb.name + ":" + zsh_text(verb.meaning)) + "\n";
  text +=
      ")\nif (( CURRENT == 2 )); then\n  _describe verb verbs\n  return\nfi\n"
      "case ${words[2]} in\n";
  for (const VerbText& verb : verbs) {
    text += "  " + verb.name + ") _arguments";
    for (const OptionText& option : verb.options)
      for (const std::string& name : option.names)
        text += " " + quoted(name + "[" + zsh_text(option.meaning) + "]" +
                             (option.takes_value ? ":value:_files" : ""));
    text += " '*:file:_files' ;;\n";
  }
  return text + "esac\n";
}

std::string fish_script(const std::vector<VerbText>& verbs) {
  std::string text = "# fish completion of grouser; written by `grouser completion fish`\n";
  for (const VerbText& verb : verbs) {
    text += "complete -c grouser -n __fish_use_subcommand -a " + verb.name + " -d " +
            quoted(verb.meaning) + "\n";
    for (const OptionText& option : verb.options) {
      if (option.names.empty()) continue;
      text += "complete -c grouser -n '__fish_seen_subcommand_from " + verb.name + "'";
      for (const std::string& name : option.names)
        text += name.rfind("--", 0) == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
      text += std::string(option.takes_value ? " -r" : "") + " -d " + quoted(option.meaning) + "\n";
    }
  }
  return text;
}

// Dashes that are typed, and no request at the start of a line.
std::string troff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '-')
      out += "\\-";
    else if (c == '\\')
      out += "\\e";
    else
      out += c;
  }
  return out.rfind('.', 0) == 0 || out.rfind('\'', 0) == 0 ? "\\&" + out : out;
}

}  // namespace

std::vector<VerbText> list_verbs(const CLI::App& app) {
  std::vector<VerbText> verbs;
  for (const CLI::App* one : app.get_subcommands(nullptr)) {
    VerbText& verb = verbs.emplace_back();
    verb.name = one->get_name();
    verb.meaning = one->get_description();
    for (const CLI::Option* option : one->get_options()) {
      OptionText& text = verb.options.emplace_back();
      for (const std::string& name : option->get_snames()) text.names.push_back("-" + name);
      for (const std::string& name : option->get_lnames()) text.names.push_back("--" + name);
      if (text.names.empty()) text.argument = option->get_name();
      text.takes_value = option->get_items_expected_max() > 0;
      text.meaning = option->get_description();
    }
  }
  return verbs;
}

std::string completion_script(const std::vector<VerbText>& verbs, const std::string& shell) {
  if (shell == "zsh") return zsh_script(verbs);
  return shell == "fish" ? fish_script(verbs) : bash_script(verbs);
}

std::string manual_page(const std::string& meaning, const std::vector<VerbText>& verbs) {
  std::string text = ".TH GROUSER 1\n.SH NAME\ngrouser \\- " + troff(meaning) +
                     "\n.SH SYNOPSIS\n.B grouser\n.I VERB\n[OPTIONS]\n.SH VERBS\n";
  for (const VerbText& verb : verbs) {
    text += ".SS " + troff(verb.name) + "\n" + troff(verb.meaning) + "\n";
    for (const OptionText& option : verb.options)
      text += ".TP\n.B " + troff(option.names.empty() ? option.argument : words_of(option)) +
              (option.takes_value && !option.names.empty() ? " VALUE" : "") + "\n" +
              troff(option.meaning) + "\n";
  }
  return text +
         ".SH EXIT STATUS\n0 done, 1 something waits for a person, 2 wrong command line, "
         "20 input, 40 storage, 70 defect, 75 another manager is at work.\n";
}

}  // namespace grouser
