#include "skeleton/links/branches.h"

#include <algorithm>

namespace palpate::skeleton {

Branches::Branches(const std::vector<Link>& links, const std::vector<char>& moves) {
    const auto moving = std::ssize(moves) - std::count(moves.begin(), moves.end(), 0);
    const auto joints = std::count_if(links.begin(), links.end(),
                                      [&](const Link& link) { return moves[link.a] != 0 || moves[link.b] != 0; });
    if (moving != joints) return;  // with all held ones as one root, a tree has a link for each other node

    std::vector<std::vector<int>> neighbours(moves.size());
    for (const Link& link : links) {
        neighbours[link.a].push_back(link.b);
        neighbours[link.b].push_back(link.a);
    }
    std::vector<int> reached;
    std::vector<char> is_new = moves;
    for (int i = 0; i < static_cast<int>(moves.size()); ++i) {
        if (moves[i] == 0) reached.push_back(i);
    }
    for (std::size_t next = 0; next < reached.size(); ++next) {
        for (const int i : neighbours[reached[next]]) {
            if (is_new[i] == 0) continue;
            is_new[i] = 0;
            tree_edges_.push_back({i, reached[next]});
            reached.push_back(i);
        }
    }
    if (std::ssize(tree_edges_) < moving) tree_edges_.clear();  // some hang on nothing that is held
}

}  // namespace palpate::skeleton
