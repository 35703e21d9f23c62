#include "skeleton/runtime/walk_order.h"

#include <algorithm>
#include <numeric>

namespace palpate::runtime {

namespace {

std::vector<int> walk(const skeleton::Model& model) {
    std::vector<std::vector<int>> neighbours(model.spheres.size());
    for (const skeleton::Link& link : model.links) {
        neighbours[link.a].push_back(link.b);
        neighbours[link.b].push_back(link.a);
    }
    const auto degree = [&](int i) { return neighbours[i].size(); };
    std::vector<int> starts(model.spheres.size());
    std::iota(starts.begin(), starts.end(), 0);
    std::ranges::stable_sort(starts, {}, degree);
    std::vector<int> met;
    std::vector<char> seen(model.spheres.size(), 0);
    for (const int start : starts) {
        if (seen[start]) continue;
        seen[start] = 1;
        met.push_back(start);
        for (std::size_t next = met.size() - 1; next < met.size(); ++next) {
            std::vector<int>& around = neighbours[met[next]];
            std::ranges::stable_sort(around, {}, degree);
            for (const int i : around) {
                if (!seen[i]) met.push_back(i);
                seen[i] = 1;
            }
        }
    }
    return met;
}

}  // namespace

ReorderedModel in_cuthill_mckee_order(const skeleton::Model& model) {
    ReorderedModel result{model, std::vector<int>(model.spheres.size())};
    const std::vector<int> met = walk(model);
    for (std::size_t p = 0; p < met.size(); ++p) {
        result.place[met[p]] = static_cast<int>(p);
        result.model.spheres[p] = model.spheres[met[p]];
    }
    for (skeleton::Link& link : result.model.links) {
        link.a = result.place[link.a];
        link.b = result.place[link.b];
    }
    std::ranges::stable_sort(result.model.links, {}, [](const skeleton::Link& link) {
        return std::pair(std::min(link.a, link.b), std::max(link.a, link.b));
    });
    for (skeleton::Attachment& point : result.model.skin) {
        for (skeleton::SphereInfluence& share : point.shares) share.sphere = result.place[share.sphere];
    }
    return result;
}

}  // namespace palpate::runtime
