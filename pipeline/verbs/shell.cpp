#include "pipeline/shell/command_tree.h"
#include "pipeline/verbs/tree.h"
#include "pipeline/verbs/verbs.h"
#include "pipeline/version.h"

// Verbs around the work: to begin, to look, and for the shell.

namespace palpate::pipeline {

void Verbs::add_new(CLI::App& app) {
    auto* sub =
        verb(app, "new", "A commented case to start from.", "  palpate new my-body && palpate run my-body/case.yaml\n",
             [this] { return commands::new_case(new_case, common); });
    sub->add_option("NAME", new_case.folder, "The folder to make")->required();
}

void Verbs::add_info(CLI::App& app) {
    auto* sub = verb(
        app, "info", "What any of our files holds.",
        "  palpate info liver-run\n  palpate info liver-run/identify/posterior.csv\n  palpate info model.json --json\n",
        [this] { return commands::info(info, common); });
    sub->add_option("FILE", info.file, "A run folder, set, case, model, result, table, series or mesh")->required();
}

void Verbs::add_completion(CLI::App& app) {
    auto* sub = verb(app, "completion", "A script that completes commands in a shell.",
                     "  source <(palpate completion bash)\n  palpate completion zsh > ~/.zfunc/_palpate\n", {});
    auto* shell = sub->add_option("SHELL", "bash or zsh")->required()->check(CLI::IsMember({"bash", "zsh"}));
    sub->callback([this, &app, shell] {
        const CommandTree tree = tree_of(app);
        const std::string text = shell->as<std::string>() == "zsh" ? zsh_completion(tree) : bash_completion(tree);
        command = [text] { return commands::Outcome{.text = text, .json = {{"script", text}}}; };
    });
}

void Verbs::add_man(CLI::App& app) {
    auto* sub = verb(app, "man", "The manual page, for 'man'.", "  palpate man | man -l -\n", {});
    sub->callback([this, &app] {
        const std::string text = man_page(tree_of(app), version);
        command = [text] { return commands::Outcome{.text = text, .json = {{"page", text}}}; };
    });
}

}  // namespace palpate::pipeline
